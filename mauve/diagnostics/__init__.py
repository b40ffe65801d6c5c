"""Diagnostics as data, their rule table, their explanation pages and one renderer per output format."""

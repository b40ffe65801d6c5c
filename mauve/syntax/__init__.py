"""The language: text to abstract syntax (parse.py), with the messages of every mistake on the way (recover.py)."""

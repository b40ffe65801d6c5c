"""What the analyses found, told in terms of the model: results of the engines -> diagnostics that point at its text."""

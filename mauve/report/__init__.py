"""Results as text for people and as JSON for programs. Renderers only: nothing is computed here that a result does
not say.
"""

"""Abstract execution of a whole program from its linked data: every value is a number, an address in the stack, or
unknown, and every path that unknown values leave open is followed."""

"""Chapter 2 of the dissertation: experiments."""

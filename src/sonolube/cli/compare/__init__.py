"""Commands that compare models with published data and identify parameters from them."""

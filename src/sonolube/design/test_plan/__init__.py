"""Plans of friction tests: points that separate friction models, replicates, order of runs, protocols and tables."""

"""Plans of friction tests: points that tell closures apart, replicates, order of the runs, protocols and tables."""

"""Statistics of measured series: confidence intervals, correlation and fits of logarithms."""

"""Models against published tests

Two models, fitted to all other sets of tests where they have a parameter, and their prediction for the set left out,
over what was measured. On the diagonal a model would be right.
"""

import sonolube as sl

figure = sl.plot(sl.compare(model=["asperity-stick-slip", "kinematic"]))

if __name__ == "__main__":
    figure.savefig("models-against-tests.png", dpi=150)

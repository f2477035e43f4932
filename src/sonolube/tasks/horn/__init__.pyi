from .poisson_horn_face import face as face
from .tuned_horn import design as design

from .horns import design as design, face as face

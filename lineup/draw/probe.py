"""Exit with 0 if VTK can draw off screen here; run apart, for VTK may crash where it cannot."""

import sys

import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 - makes the factory produce OpenGL windows
from vtkmodules.vtkFiltersSources import vtkConeSource
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkWindowToImageFilter,
)


def contrast() -> float:
    """Difference between the brightest and the darkest pixel of a picture of a cone."""
    cone = vtkConeSource()
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(cone.GetOutputPort())
    actor = vtkActor()
    actor.SetMapper(mapper)
    renderer = vtkRenderer()
    renderer.AddActor(actor)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetSize(64, 64)
    window.AddRenderer(renderer)
    window.Render()
    picture = vtkWindowToImageFilter()
    picture.SetInput(window)
    picture.Update()
    darkest, brightest = picture.GetOutput().GetScalarRange()
    return float(brightest - darkest)


if __name__ == "__main__":
    sys.exit(0 if contrast() > 1 else 1)

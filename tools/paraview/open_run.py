"""Opens a run folder in ParaView, ready to look at: the tracked surfaces side by side in their checker colours,
the walls, and the real time of every frame.

In the application:   KAPPAFLOW_RUN=out/staircase paraview --script=tools/paraview/open_run.py
Without a window:     xvfb-run -a -s -noreset pvbatch tools/paraview/open_run.py out/staircase picture.png
The picture shows the last frame, or the frame nearest to the time [s] given as a third word.
"""

import json
import math
import os
import sys
from xml.etree import ElementTree

from paraview import simple


def series(run):
    """The surface series of a run folder, by method name, in the order in which they were tracked."""
    collection = ElementTree.parse(os.path.join(run, "run.pvd")).getroot().find("Collection")
    folders = dict.fromkeys(entry.get("file").split("/")[0] for entry in collection)
    return {name[len("surface-"):]: os.path.join(run, name + ".pvd") for name in folders if name.startswith("surface-")}


def show(run, method, pvd, view):
    surface = simple.PVDReader(registrationName=method, FileName=pvd)
    display = simple.Show(surface, view)
    simple.ColorBy(display, ("POINTS", "checker"))
    display.MapScalars = 0  # checker holds colours, not values to look up
    display.SetScalarBarVisibility(view, False)
    at_rest, moving = os.path.join(run, "boundary.vtp"), os.path.join(run, "boundary.pvd")
    if os.path.exists(at_rest) or os.path.exists(moving):
        if os.path.exists(moving):
            walls = simple.PVDReader(registrationName="walls", FileName=moving)
        else:
            walls = simple.XMLPolyDataReader(registrationName="walls", FileName=[at_rest])
        walls_display = simple.Show(walls, view)
        walls_display.ColorArrayName = [None, ""]
        walls_display.DiffuseColor = [0.8, 0.8, 0.8]
    label = simple.Text(registrationName=method + " label", Text=method)
    label_display = simple.Show(label, view)
    label_display.Color = [0, 0, 0]
    label_display.FontSize = 24
    view.UseColorPaletteForBackground = 0
    view.Background = [1, 1, 1]
    view.OrientationAxesVisibility = 0


def aim(view, run, liquid=None):
    """From where the run's scene says, else from above at an angle with y up, so that all fills the view, or what is
    within these bounds."""
    with open(os.path.join(run, "run.json"), encoding="utf-8") as record:
        direction = json.load(record).get("view", {"from": [0.9, 0.65, 1], "up": [0, 1, 0]})
    view.CameraFocalPoint = [0, 0, 0]
    view.CameraPosition = direction["from"]
    view.CameraViewUp = direction["up"]
    view.CameraViewAngle = 24
    simple.ResetCamera(view)
    if liquid is None:
        return
    centre = [0.5 * (liquid[2 * axis] + liquid[2 * axis + 1]) for axis in range(3)]
    radius = 0.5 * math.dist(liquid[0::2], liquid[1::2])
    away = 1.1 * radius / math.sin(math.radians(view.CameraViewAngle / 2)) / math.hypot(*direction["from"])
    view.CameraFocalPoint = centre
    view.CameraPosition = [c + away * d for c, d in zip(centre, direction["from"])]


def open_run(run):
    methods = series(run)
    if not methods:
        sys.exit(f"{run}/run.pvd names no tracked surface")
    simple._DisableFirstRenderCameraReset()
    layout = simple.CreateLayout(name="kappaflow")
    views = []
    for index, (method, pvd) in enumerate(methods.items()):
        view = simple.CreateView("RenderView")
        if views:  # the last view keeps its share, the new one gets the rest
            layout.SplitViewHorizontal(views[-1], 1 / (len(methods) - index + 1))
        simple.AssignViewToLayout(view=view, layout=layout)
        show(run, method, pvd, view)
        views.append(view)
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    return layout, views, methods, scene


def main():
    run = sys.argv[1] if len(sys.argv) > 1 else os.environ.get("KAPPAFLOW_RUN", "")
    if not os.path.exists(os.path.join(run, "run.pvd")):
        sys.exit(f"'{run}' holds no run.pvd; name a run folder as the first word or in KAPPAFLOW_RUN")
    layout, views, methods, scene = open_run(run)
    times = scene.TimeKeeper.TimestepValues
    wanted = float(sys.argv[3]) if len(sys.argv) > 3 else times[-1]
    scene.AnimationTime = min(times, key=lambda time: abs(time - wanted))
    liquid = None
    for view, method in zip(views, methods):
        simple.Render(view)
        if len(sys.argv) > 2:  # a picture is of the liquid; who plays the run sees all of it
            liquid = liquid or simple.FindSource(method).GetDataInformation().GetBounds()
        aim(view, run, liquid)
    for number, view in enumerate(views[1:], start=2):
        simple.AddCameraLink(views[0], view, f"camera of view {number}")
    if len(sys.argv) > 2:
        layout.SetSize(640 * len(views), 560)
        simple.SaveScreenshot(sys.argv[2], layout)


main()

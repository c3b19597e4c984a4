#!/usr/bin/env python3
"""Writes frames_N.pvtp and .pvtu with their pieces, and files without points, as VTK's writers do: a block of 6 x 5 x 4 particles
that moves, in two pieces in frame 0, with none left for a third, and in three in frame 1, each with a layer of ghosts; and
image.pvti, of 10 x 6 x 5 points in three pieces with a layer of ghosts, in a folder of their own. Needs VTK's Python package.
"""
import vtk
import vtk.util.vtkAlgorithm

SPACING, SIZE, PIECES = 0.1, (6, 5, 4), 3


def time_value(time):
    array = vtk.vtkDoubleArray()
    array.SetName("TimeValue")
    array.InsertNextValue(time)
    return array


def piece(grid, frame, number):
    """Columns of three or two particles; ghosts are the columns beside them."""
    points, ids, velocity, ghost = vtk.vtkPoints(), vtk.vtkTypeInt64Array(), vtk.vtkDoubleArray(), vtk.vtkUnsignedCharArray()
    points.SetDataTypeToDouble()
    velocity.SetNumberOfComponents(3)
    for array, name in ((ids, "id"), (velocity, "velocity"), (ghost, "vtkGhostType")):
        array.SetName(name)
    for k in range(SIZE[2]):
        for j in range(SIZE[1]):
            for i in range(SIZE[0]):
                owner = i // 3 if frame == 0 else i // 2
                near = any(0 <= n < SIZE[0] and (n // 3 if frame == 0 else n // 2) == number for n in (i - 1, i + 1))
                if owner != number and not near:
                    continue
                points.InsertNextPoint(SPACING * i + 0.05 * frame, SPACING * j, SPACING * k)
                ids.InsertNextValue(5 + 3 * ((k * SIZE[1] + j) * SIZE[0] + i))
                velocity.InsertNextTuple3(0.5, 0, 0)
                ghost.InsertNextValue(0 if owner == number else vtk.vtkDataSetAttributes.DUPLICATEPOINT)
    data = vtk.vtkUnstructuredGrid() if grid else vtk.vtkPolyData()
    data.SetPoints(points)
    cells = vtk.vtkCellArray()
    for p in range(points.GetNumberOfPoints()):
        cells.InsertNextCell(1, [p])
    if grid:
        data.SetCells(vtk.VTK_VERTEX, cells)
    else:
        data.SetVerts(cells)
    for array in (ids, velocity, ghost):
        data.GetPointData().AddArray(array)
    data.GetFieldData().AddArray(time_value(0.1 * frame))
    return data


class Pieces(vtk.util.vtkAlgorithm.VTKPythonAlgorithmBase):
    """Gives the writer the piece that it asks for."""

    def __init__(self, grid, frame):
        kind = "vtkUnstructuredGrid" if grid else "vtkPolyData"
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType=kind)
        self.grid, self.frame = grid, frame

    def RequestInformation(self, request, inputs, output):
        output.GetInformationObject(0).Set(vtk.vtkAlgorithm.CAN_HANDLE_PIECE_REQUEST(), 1)
        return 1

    def RequestData(self, request, inputs, output):
        info = output.GetInformationObject(0)
        number = info.Get(vtk.vtkStreamingDemandDrivenPipeline.UPDATE_PIECE_NUMBER())
        vtk.vtkDataObject.GetData(output).ShallowCopy(piece(self.grid, self.frame, number))
        return 1


class ImagePieces(vtk.util.vtkAlgorithm.VTKPythonAlgorithmBase):
    """Gives the writer the part of an image that it asks for."""

    ORIGIN, STEP, LAST = (1, 2, 3), (0.5, 0.25, 0.125), (9, 5, 4)

    def __init__(self):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkImageData")

    def RequestInformation(self, request, inputs, output):
        info = output.GetInformationObject(0)
        info.Set(vtk.vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT(), [n for last in self.LAST for n in (0, last)], 6)
        info.Set(vtk.vtkDataObject.ORIGIN(), self.ORIGIN, 3)
        info.Set(vtk.vtkDataObject.SPACING(), self.STEP, 3)
        info.Set(vtk.vtkAlgorithm.CAN_PRODUCE_SUB_EXTENT(), 1)
        return 1

    def RequestData(self, request, inputs, output):
        info = output.GetInformationObject(0)
        extent = info.Get(vtk.vtkStreamingDemandDrivenPipeline.UPDATE_EXTENT())
        image = vtk.vtkDataObject.GetData(output)
        image.SetExtent(*extent)
        image.SetOrigin(*self.ORIGIN)
        image.SetSpacing(*self.STEP)
        phi = vtk.vtkFloatArray()
        phi.SetName("phi")
        for k in range(extent[4], extent[5] + 1):
            for j in range(extent[2], extent[3] + 1):
                for i in range(extent[0], extent[1] + 1):
                    phi.InsertNextValue(i + 10 * j + 100 * k)
        image.GetPointData().AddArray(phi)
        image.GetFieldData().AddArray(time_value(0.75))
        return 1


for grid in (False, True):
    for frame in range(2):
        source = Pieces(grid, frame)
        writer = vtk.vtkXMLPUnstructuredGridWriter() if grid else vtk.vtkXMLPPolyDataWriter()
        writer.SetInputConnection(source.GetOutputPort())
        writer.SetFileName(f"frames_{frame}.{'pvtu' if grid else 'pvtp'}")
        writer.SetNumberOfPieces(PIECES)
        writer.SetStartPiece(0)
        writer.SetEndPiece(PIECES - 1)
        writer.SetGhostLevel(1)
        if grid:
            writer.SetDataModeToBinary()
        writer.Write()
images = ImagePieces()
writer = vtk.vtkXMLPImageDataWriter()
writer.SetInputConnection(images.GetOutputPort())
writer.SetFileName("image.pvti")
writer.SetUseSubdirectory(True)
writer.SetNumberOfPieces(PIECES)
writer.SetStartPiece(0)
writer.SetEndPiece(PIECES - 1)
writer.SetGhostLevel(1)
writer.Write()
for data, writer, name in ((vtk.vtkPolyData(), vtk.vtkXMLPolyDataWriter(), "empty.vtp"),
                           (vtk.vtkUnstructuredGrid(), vtk.vtkXMLUnstructuredGridWriter(), "empty.vtu")):
    writer.SetInputData(data)
    writer.SetFileName(name)
    writer.Write()

// Obstacles as surfaces (outlines in 2D): exact where the shape is simple, otherwise the zero of the signed distance, sampled once a cell.
#include <vtkAppendPolyData.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCleanPolyData.h>
#include <vtkCubeSource.h>
#include <vtkDoubleArray.h>
#include <vtkFlyingEdges2D.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkLineSource.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkSphereSource.h>
#include <vtkTubeFilter.h>
#include <vtkUnsignedIntArray.h>

#include <algorithm>
#include <cmath>

#include "io/vtk.hpp"
#include "scene/height_map_file.hpp"

namespace jaxmpm {
namespace {

using PolyData = vtkSmartPointer<vtkPolyData>;
constexpr int round_sides = 64;

template <class Source>
PolyData output_of(Source& source) {
  source->Update();
  return source->GetOutput();
}

PolyData outline(const std::vector<deck::Numbers>& corners) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> polygon;
  polygon->InsertNextCell(static_cast<int>(corners.size()));
  for (const deck::Numbers& x : corners) polygon->InsertCellPoint(points->InsertNextPoint(x[0], x[1], 0));
  const auto surface = PolyData::New();
  surface->SetPoints(points);
  surface->SetPolys(polygon);
  return surface;
}

/// The solid below a profile, down to the domain's bottom.
PolyData ground_outline(const Surface& ground, const Frame& frame) {
  std::vector<deck::Numbers> corners;
  const auto add = [&](double u, double height) {
    const Point x = frame.metres({u, height, 0});
    corners.push_back({x[0], x[1]});
  };
  for (int i = 0; i <= frame.cells[0]; ++i) add(i, ground.sample(i, 0).height);
  add(frame.cells[0], 0);
  add(0, 0);
  return outline(corners);
}

/// Heights above the lattice's nodes, joined by quadrilaterals.
PolyData ground_surface(const Surface& ground, const Frame& frame) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int j = 0; j <= frame.cells[1]; ++j)
    for (int i = 0; i <= frame.cells[0]; ++i)
      points->InsertNextPoint(frame.metres({double(i), double(j), ground.sample(i, j).height}).data());
  vtkNew<vtkCellArray> quads;
  const vtkIdType row = frame.cells[0] + 1;
  for (vtkIdType j = 0; j < frame.cells[1]; ++j)
    for (vtkIdType i = 0; i < frame.cells[0]; ++i) {
      const vtkIdType corner = j * row + i, corners[4] = {corner, corner + 1, corner + row + 1, corner + row};
      quads->InsertNextCell(4, corners);
    }
  const auto surface = PolyData::New();
  surface->SetPoints(points);
  surface->SetPolys(quads);
  return surface;
}

/// Overloads for shapes with an exact surface; the rest is sampled.
struct Exact {
  int dim;
  Frame frame;
  std::string pointer;  // of the obstacle's shape
  PolyData operator()(const deck::Box& box) const {
    const deck::Numbers &a = box.min, &b = box.max;
    if (dim == 2) return outline({{a[0], a[1]}, {b[0], a[1]}, {b[0], b[1]}, {a[0], b[1]}});
    vtkNew<vtkCubeSource> source;
    source->SetBounds(a[0], b[0], a[1], b[1], a[2], b[2]);
    source->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    return output_of(source);
  }
  PolyData operator()(const deck::Sphere& sphere) const {
    if (dim == 2) {
      std::vector<deck::Numbers> circle;
      for (int k = 0; k < round_sides; ++k) {
        const double angle = 2 * M_PI * k / round_sides;
        circle.push_back({sphere.center[0] + sphere.radius * std::cos(angle), sphere.center[1] + sphere.radius * std::sin(angle)});
      }
      return outline(circle);
    }
    vtkNew<vtkSphereSource> source;
    source->SetCenter(sphere.center[0], sphere.center[1], sphere.center[2]);
    source->SetRadius(sphere.radius);
    source->SetThetaResolution(round_sides);
    source->SetPhiResolution(round_sides / 2);
    source->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    return output_of(source);
  }
  PolyData operator()(const deck::Cylinder& cylinder) const {
    vtkNew<vtkLineSource> axis;
    axis->SetPoint1(cylinder.from[0], cylinder.from[1], cylinder.from[2]);
    axis->SetPoint2(cylinder.to[0], cylinder.to[1], cylinder.to[2]);
    axis->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    vtkNew<vtkTubeFilter> tube;
    tube->SetInputConnection(axis->GetOutputPort());
    tube->SetRadius(cylinder.radius);
    tube->SetNumberOfSides(round_sides);
    tube->CappingOn();
    tube->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    return output_of(tube);
  }
  PolyData operator()(const deck::Polygon& polygon) const { return outline(polygon.points); }
  PolyData operator()(const deck::HeightMap& map) const {
    const SurfacePointer ground = load_surface(map, frame, pointer + "/height_map");
    return dim == 2 ? ground_outline(*ground, frame) : ground_surface(*ground, frame);
  }
  template <class Other>
  PolyData operator()(const Other&) const {
    return nullptr;
  }
};

/// Signed distance at the nodes of a block of cells; lengths in cells.
vtkSmartPointer<vtkImageData> sample(const RigidObstacle& obstacle, const Model& model, const std::array<int, 3>& first,
                                     const std::array<int, 3>& nodes) {
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(nodes.data());
  image->SetOrigin(first[0], first[1], first[2]);
  vtkNew<vtkDoubleArray> distance;
  for (int k = 0; k < nodes[2]; ++k)
    for (int j = 0; j < nodes[1]; ++j)
      for (int i = 0; i < nodes[0]; ++i) {
        const Point x{double(first[0] + i), double(first[1] + j), model.dim == 3 ? double(first[2] + k) : 0};
        distance->InsertNextValue(obstacle.signed_distance(x).distance);
      }
  image->GetPointData()->SetScalars(distance);
  return image;
}

PolyData contour(vtkImageData* image, int dim) {
  if (dim == 2) {
    vtkNew<vtkFlyingEdges2D> edges;
    edges->SetInputData(image);
    edges->SetValue(0, 0.0);
    return output_of(edges);
  }
  vtkNew<vtkFlyingEdges3D> edges;
  edges->SetInputData(image);
  edges->SetValue(0, 0.0);
  edges->ComputeNormalsOff();
  edges->ComputeScalarsOff();
  return output_of(edges);
}

/// Cells from domain.min to deck coordinates, in double precision: the contour's own points are single.
void to_metres(vtkPolyData* data, const Model& model) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType n = 0; n < data->GetNumberOfPoints(); ++n) {
    Point x{};
    data->GetPoint(n, x.data());
    for (int a = 0; a < model.dim; ++a) x[a] = model.domain_min[a] + x[a] * model.cell_size;
    points->InsertNextPoint(x.data());
  }
  data->SetPoints(points);
}

/// The zero of the signed distance inside the domain, block by block, so that only the neighbourhood of the surface is sampled.
PolyData sampled(const RigidObstacle& obstacle, const Model& model) {
  constexpr int block = 8;  // cells
  vtkNew<vtkAppendPolyData> all;
  all->AddInputData(vtkNew<vtkPolyData>());
  std::array<int, 3> first{};
  for (first[2] = 0; first[2] < (model.dim == 3 ? model.cells[2] : 1); first[2] += block)
    for (first[1] = 0; first[1] < model.cells[1]; first[1] += block)
      for (first[0] = 0; first[0] < model.cells[0]; first[0] += block) {
        std::array<int, 3> nodes{1, 1, 1};
        Point lower{}, upper{};
        for (int a = 0; a < model.dim; ++a) {
          const int cells = std::min(block, model.cells[a] - first[a]);
          nodes[a] = cells + 1;
          lower[a] = first[a];
          upper[a] = first[a] + cells;
        }
        if (!obstacle.may_touch(lower, upper)) continue;
        const PolyData part = contour(sample(obstacle, model, first, nodes), model.dim);
        part->GetPointData()->Initialize();
        if (part->GetNumberOfCells() > 0) all->AddInputData(part);
      }
  vtkNew<vtkCleanPolyData> joined;
  joined->SetInputConnection(all->GetOutputPort());
  const PolyData surface = output_of(joined);
  surface->SetVerts(nullptr);  // what became of triangles without area, where the surface passes through a node
  if (model.dim == 3) surface->SetLines(nullptr);
  to_metres(surface, model);
  return surface;
}

}  // namespace

void write_vtk_obstacles(const std::string& path, const deck::Deck& deck, const Model& model) {
  vtkNew<vtkAppendPolyData> all;
  all->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  for (std::size_t o = 0; o < model.obstacles.size(); ++o) {
    PolyData surface =
        std::visit(Exact{model.dim, make_frame(deck), "/obstacles/" + std::to_string(o) + "/shape"}, deck.obstacles[o].shape.kind);
    if (!surface) surface = sampled(model.obstacles[o], model);
    surface->GetPointData()->Initialize();
    vtkNew<vtkUnsignedIntArray> number;
    number->SetName("obstacle");
    for (vtkIdType c = 0; c < surface->GetNumberOfCells(); ++c) number->InsertNextValue(static_cast<unsigned>(o));
    surface->GetCellData()->AddArray(number);
    all->AddInputData(surface);
  }
  all->Update();
  write_polydata(path, all->GetOutput());
}

}  // namespace jaxmpm

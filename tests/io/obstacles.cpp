// Obstacles as surfaces, read back with VTK's own reader.
#include <vtkCellData.h>
#include <vtkMassProperties.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkTriangleFilter.h>
#include <vtkXMLPolyDataReader.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "io/vtk.hpp"
#include "scratch.hpp"

using namespace jaxmpm;
using testing::Scratch;

namespace {

struct Scene3D {
  deck::Deck deck;
  Model model;
};

/// A domain of 2 m far from the origin, 20 cells wide, with one obstacle.
Scene3D scene_with(const deck::Shape& shape, int dim, std::function<double(const Point&)> distance) {
  Scene3D scene;
  const std::vector<double> low{1000, 2000, 300};
  scene.model.dim = dim;
  scene.model.cell_size = 0.1;
  for (int a = 0; a < dim; ++a) {
    scene.model.domain_min[a] = low[a];
    scene.model.cells[a] = 20;
    scene.deck.domain.min.push_back(low[a]);
    scene.deck.domain.max.push_back(low[a] + 2);
  }
  scene.deck.domain.cell_size = 0.1;
  deck::Obstacle obstacle;
  obstacle.name = "rock";
  obstacle.shape = shape;
  scene.deck.obstacles.push_back(obstacle);
  scene.model.obstacles.push_back({"rock", deck::ContactKind::slip, 0,
                                   [distance](const Point& x) {
                                     return SignedDistance{distance(x), {}};
                                   },
                                   [](const Point&, const Point&) { return true; }});
  return scene;
}

void read(const std::string& path, const Scene3D& scene, vtkXMLPolyDataReader* reader) {
  write_vtk_obstacles(path, scene.deck, scene.model);
  reader->SetFileName(path.c_str());
  reader->Update();
}

double volume(vtkPolyData* surface) {
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputData(surface);
  vtkNew<vtkMassProperties> properties;
  properties->SetInputConnection(triangles->GetOutputPort());
  properties->Update();
  return properties->GetVolume();
}

}  // namespace

TEST_CASE("a box and a sphere are exact, a union is sampled from its signed distance") {
  const Scratch scratch;
  vtkNew<vtkXMLPolyDataReader> reader;
  const deck::Box box{{1000.5, 2000.5, 300}, {1001, 2001.5, 301}};
  const deck::Sphere ball{{1001, 2001, 301}, 0.5};

  read(scratch / "box.vtp", scene_with({box}, 3, nullptr), reader);
  CHECK(volume(reader->GetOutput()) == Approx(0.5));
  CHECK(reader->GetOutput()->GetBounds()[2] == 2000.5);
  CHECK(reader->GetOutput()->GetCellData()->GetArray("obstacle")->GetTuple1(0) == 0);

  read(scratch / "ball.vtp", scene_with({ball}, 3, nullptr), reader);
  CHECK(volume(reader->GetOutput()) == Approx(4 * M_PI / 3 * 0.125).epsilon(0.01));

  const auto distance = [](const Point& x) { return std::hypot(std::hypot(x[0] - 10, x[1] - 10), x[2] - 10) - 5; };
  read(scratch / "union.vtp", scene_with({deck::Union{{{ball}, {ball}}}}, 3, distance), reader);
  CHECK(volume(reader->GetOutput()) == Approx(4 * M_PI / 3 * 0.125).epsilon(0.03));  // chords of a sphere of five cells
  CHECK(reader->GetOutput()->GetBounds()[0] == Approx(1000.5).margin(1e-3));
}

TEST_CASE("outlines in 2D") {
  const Scratch scratch;
  vtkNew<vtkXMLPolyDataReader> reader;
  read(scratch / "polygon.vtp", scene_with({deck::Polygon{{{1000, 2000}, {1001, 2000}, {1000, 2001}}}}, 2, nullptr), reader);
  CHECK(reader->GetOutput()->GetNumberOfPolys() == 1);
  CHECK(reader->GetOutput()->GetNumberOfPoints() == 3);
}

TEST_CASE("a height map is a surface over the whole domain") {
  const Scratch scratch;
  std::ofstream(scratch / "plane.asc") << "ncols 3\nnrows 3\nxllcorner 999.5\nyllcorner 1999.5\ncellsize 1\nNODATA_value -9999\n"
                                       << "300 301 302\n300 301 302\n300 301 302\n";
  vtkNew<vtkXMLPolyDataReader> reader;
  read(scratch / "ground.vtp", scene_with({deck::HeightMap{scratch / "plane.asc", {0, 0, 0}, 1}}, 3, nullptr), reader);
  vtkPolyData* ground = reader->GetOutput();
  CHECK(ground->GetNumberOfPoints() == 21 * 21);
  CHECK(ground->GetNumberOfPolys() == 400);
  for (vtkIdType n = 0; n < ground->GetNumberOfPoints(); n += 37)
    CHECK(ground->GetPoint(n)[2] - 300 == Approx(ground->GetPoint(n)[0] - 1000).margin(1e-5));
}

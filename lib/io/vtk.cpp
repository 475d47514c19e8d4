#include "io/vtk.hpp"

#include <spdlog/fmt/fmt.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnsignedIntArray.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <set>
#include <type_traits>

#include "io/files.hpp"

namespace jaxmpm {
namespace {

namespace fs = std::filesystem;

std::size_t total(const std::vector<BodySnapshot>& bodies) {
  std::size_t count = 0;
  for (const BodySnapshot& body : bodies) count += body.id.size();
  return count;
}

void fill_with_numbers(vtkIdTypeArray* array, vtkIdType count) {
  vtkIdType* first = array->WritePointer(0, count);
  std::iota(first, first + count, vtkIdType(0));
}

void add_points(vtkPolyData* data, const std::vector<BodySnapshot>& bodies, int dim) {
  const auto count = static_cast<vtkIdType>(total(bodies));
  vtkNew<vtkDoubleArray> places;  // terrain in national grids needs more than seven digits
  places->SetNumberOfComponents(3);
  double* place = places->WritePointer(0, 3 * count);
  for (const BodySnapshot& body : bodies)
    for (std::size_t p = 0; p < body.id.size(); ++p)
      for (int a = 0; a < 3; ++a) *place++ = a < dim ? body.position[p * dim + a] : 0;
  vtkNew<vtkPoints> points;
  points->SetData(places);
  vtkNew<vtkIdTypeArray> ends, members;  // cell n is point n alone
  fill_with_numbers(ends, count + 1), fill_with_numbers(members, count);
  vtkNew<vtkCellArray> vertices;
  vertices->SetData(ends, members);
  data->SetPoints(points);
  data->SetVerts(vertices);
}

/// ParaView takes vectors of three components only, and tensors of six or nine.
std::vector<std::size_t> padded_places(Rank rank, int dim) {
  if (dim == 3 || rank == Rank::scalar || rank == Rank::symmetric) {
    std::vector<std::size_t> all(component_count(rank, dim));
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
    return all;
  }
  return rank == Rank::vector ? std::vector<std::size_t>{0, 1} : std::vector<std::size_t>{0, 1, 3, 4};
}

std::size_t padded_count(Rank rank, int dim) { return rank == Rank::vector ? 3 : rank == Rank::gradient ? 9 : component_count(rank, dim); }

template <class Array>
void add_field(vtkPolyData* data, const OutputField& field, const std::vector<BodySnapshot>& bodies, int dim) {
  const std::size_t components = component_count(field.rank, dim), width = padded_count(field.rank, dim);
  const std::vector<std::size_t> places = padded_places(field.rank, dim);
  vtkNew<Array> array;
  array->SetName(field.name.c_str());
  array->SetNumberOfComponents(static_cast<int>(width));
  auto* value = array->WritePointer(0, static_cast<vtkIdType>(width * total(bodies)));
  std::fill_n(value, width * total(bodies), 0);
  const std::vector<std::string> names = component_names(field.rank, 3);
  for (std::size_t k = 0; k < names.size(); ++k) array->SetComponentName(static_cast<vtkIdType>(k), names[k].c_str());
  using Value = std::remove_pointer_t<decltype(value)>;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (std::size_t p = 0; p < bodies[b].id.size(); ++p, value += width)
      for (std::size_t k = 0; k < components; ++k)
        value[places[k]] = static_cast<Value>(field_value(field, bodies[b], b, p, k, components));
  data->GetPointData()->AddArray(array);
}

std::string series_entry(double time, const std::string& part, int number, const std::string& file) {
  return fmt::format("    <DataSet timestep=\"{}\" group=\"{}\" part=\"{}\" file=\"{}\"/>\n", time, part, number, file);
}

}  // namespace

void write_polydata(const std::string& path, vtkPolyData* data) {
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(data);
  writer->WriteToOutputStringOn();
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetCompressorTypeToLZ4();
  if (writer->Write() == 0) throw IoError("VTK could not encode '" + path + "' (error " + std::to_string(writer->GetErrorCode()) + ").");
  write_file(path, writer->GetOutputString());
}

void write_vtk_frame(const std::string& path, const Moment& now, const std::vector<FrameBody>& layout,
                     const std::vector<BodySnapshot>& bodies, int dim) {
  vtkNew<vtkPolyData> data;
  add_points(data, bodies, dim);
  std::set<std::string> fields{"id", "body"};
  for (const FrameBody& body : layout) fields.insert(body.fields.begin(), body.fields.end());
  for (const OutputField& field : output_fields()) {
    if (!fields.count(field.name) || field.name == "position") continue;
    if (field.values) add_field<vtkFloatArray>(data, field, bodies, dim);
    else add_field<vtkUnsignedIntArray>(data, field, bodies, dim);
  }
  vtkNew<vtkDoubleArray> time;
  time->SetName("TimeValue");  // the name by which VTK's readers know it
  time->InsertNextValue(now.time);
  data->GetFieldData()->AddArray(time);
  write_polydata(path, data);
}

void write_vtk_series(const ResultsDirectory& directory, const std::vector<FrameEntry>& frames) {
  const bool obstacles = fs::exists(directory.vtk_obstacles());
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  <Collection>\n";
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const fs::path file = directory.vtk_frame(n);
    if (!fs::exists(file)) continue;
    text += series_entry(frames[n].time, "particles", 0, file.filename().string());
    if (obstacles) text += series_entry(frames[n].time, "obstacles", 1, fs::path(directory.vtk_obstacles()).filename().string());
  }
  write_file(directory.vtk_series(), text + "  </Collection>\n</VTKFile>\n");
}

}  // namespace jaxmpm

// Maps of CGAL, to be held beside equimap's: cgal_maps METHOD MESH.off OUT.off
//   authalic: the discrete authalic map (M. Desbrun, M. Meyer, P. Alliez, Intrinsic parameterizations of surface meshes, 2002),
//   conformal: mean values (M. Floater, Mean value coordinates, 2003), both to the disk with its boundary held by arc length,
//   arap: as rigid as possible with a free boundary (L. Liu et al., A local/global approach to mesh parameterization, 2008).
// OUT has the vertices and faces of MESH, with the map as positions. Built by peers.py.
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/ARAP_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/Circular_border_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/Discrete_authalic_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/Error_code.h>
#include <CGAL/Surface_mesh_parameterization/Mean_value_coordinates_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>
#include <CGAL/Polygon_mesh_processing/measure.h>

#include <chrono>
#include <fstream>
#include <iostream>
#include <string>

typedef CGAL::Simple_cartesian<double> Kernel;
typedef CGAL::Surface_mesh<Kernel::Point_3> Mesh;
typedef boost::graph_traits<Mesh>::halfedge_descriptor Halfedge;
typedef Mesh::Property_map<Mesh::Vertex_index, Kernel::Point_2> Map;
namespace smp = CGAL::Surface_mesh_parameterization;
typedef smp::Circular_border_arc_length_parameterizer_3<Mesh> Border;

static smp::Error_code Parameterize(const std::string &method, Mesh &mesh, Halfedge border, Map map)
{
  if (method == "authalic")
    return smp::parameterize(mesh, smp::Discrete_authalic_parameterizer_3<Mesh, Border>(), border, map);
  if (method == "conformal")
    return smp::parameterize(mesh, smp::Mean_value_coordinates_parameterizer_3<Mesh, Border>(), border, map);
  return smp::parameterize(mesh, smp::ARAP_parameterizer_3<Mesh>(), border, map);
}

int main(int argc, char **argv)
{
  Mesh mesh;
  if (argc != 4 || !(std::ifstream(argv[2]) >> mesh) || mesh.is_empty()) {
    std::cerr << "usage: cgal_maps authalic|conformal|arap MESH.off OUT.off\n";
    return 2;
  }
  const Halfedge border = CGAL::Polygon_mesh_processing::longest_border(mesh).first;
  Map map = mesh.add_property_map<Mesh::Vertex_index, Kernel::Point_2>("v:map").first;
  const auto begin = std::chrono::steady_clock::now();
  const smp::Error_code code = Parameterize(argv[1], mesh, border, map);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  if (code != smp::OK) {
    std::cerr << smp::get_error_message(code) << "\n";
    return 1;
  }
  for (Mesh::Vertex_index v : mesh.vertices()) mesh.point(v) = Kernel::Point_3(map[v].x(), map[v].y(), 0.);
  std::ofstream out(argv[3]);
  out.precision(17);
  out << mesh;
  std::cout << seconds.count() << "\n";
  return out.good() ? 0 : 1;
}

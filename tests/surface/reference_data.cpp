#include "tests/surface/reference_data.h"

#include <vtk_jsoncpp.h>

#include <fstream>
#include <stdexcept>

#include "surface/field/particle_weights.h"

namespace kappaflow::testing {

namespace {

Json::Value read_json(const std::string& name) {
  const std::string path = std::string(KAPPAFLOW_SOURCE_DIR) + "/tests/data/" + name;
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  Json::Value root;
  file >> root;
  return root;
}

double number(const Json::Value& value) {
  return value.isString() ? std::stod(value.asString()) : value.asDouble();
}

Vec3 vector(const Json::Value& v) {
  return {number(v[0]), number(v[1]), number(v[2])};
}

Mat3 symmetric(const Json::Value& v) {
  Mat3 m;
  m << number(v[0]), number(v[1]), number(v[2]),  //
      number(v[1]), number(v[3]), number(v[4]),   //
      number(v[2]), number(v[4]), number(v[5]);
  return m;
}

ThirdDerivatives third(const Json::Value& v) {
  return {number(v["xxx"]), number(v["xxy"]), number(v["xxz"]), number(v["xyy"]), number(v["xyz"]),
          number(v["xzz"]), number(v["yyy"]), number(v["yyz"]), number(v["yzz"]), number(v["zzz"])};
}

void add_particle(FieldParticles& p, const Vec3& position, const Vec3& velocity, double sigma,
                  double weight) {
  p.position.push_back(position);
  p.velocity.push_back(velocity);
  p.sigma.push_back(sigma);
  p.weight.push_back(weight);
  p.weight_rate.push_back(0);
}

JetCase read_case(const Json::Value& v) {
  JetCase c;
  for (const Json::Value& p : v["particles"])
    add_particle(c.particles, vector(p["center"]), vector(p["velocity"]), number(p["radius"]),
                 number(p["weight"]));
  c.threshold = number(v["threshold"]);
  c.x = vector(v["x"]);
  c.jet.f = number(v["f"]);
  c.jet.g = vector(v["grad"]);
  c.jet.A = symmetric(v["hess"]);
  c.jet.C = third(v["third"]);
  c.jet.f_t = number(v["f_t"]);
  c.jet.g_t = vector(v["grad_t"]);
  c.jet.A_t = symmetric(v["hess_t"]);
  c.curvature = {.K = number(v["K"]),
                 .H = number(v["H"]),
                 .grad_K = vector(v["grad_K"]),
                 .grad_H = vector(v["grad_H"]),
                 .K_t = number(v["K_t"]),
                 .H_t = number(v["H_t"])};
  return c;
}

SymmetricMatrix entries(const Json::Value& v) {
  SymmetricMatrix m;
  for (int ab = 0; ab < 6; ++ab) m[ab] = number(v[ab]);
  return m;
}

KernelCase read_kernel_case(const Json::Value& v) {
  KernelCase c;
  for (const Json::Value& k : v["kernels"]) {
    c.kernels.center.push_back(vector(k["center"]));
    c.kernels.velocity.push_back(vector(k["velocity"]));
    c.kernels.shape.push_back(entries(k["shape"]));
    c.kernels.shape_rate.push_back(entries(k["shape_rate"]));
    c.kernels.weight.push_back(number(k["weight"]));
    c.kernels.weight_rate.push_back(number(k["weight_rate"]));
  }
  c.threshold = number(v["threshold"]);
  c.x = vector(v["x"]);
  const Json::Value& e = v["expected"];
  const Json::Value& t = e["third"];
  c.jet = {.f = number(e["f"]),
           .g = vector(e["grad"]),
           .A = symmetric(e["hess"]),
           .C = {number(t[0]), number(t[1]), number(t[2]), number(t[3]), number(t[4]), number(t[5]),
                 number(t[6]), number(t[7]), number(t[8]), number(t[9])},
           .f_t = number(e["f_t"]),
           .g_t = vector(e["grad_t"]),
           .A_t = symmetric(e["hess_t"])};
  return c;
}

}  // namespace

std::vector<KernelCase> read_kernel_cases() {
  std::vector<KernelCase> cases;
  const Json::Value root = read_json("kernel_jets.json");
  for (const Json::Value& v : root["cases"]) cases.push_back(read_kernel_case(v));
  return cases;
}

std::vector<JetCase> read_jet_cases() {
  std::vector<JetCase> cases;
  const Json::Value root = read_json("field_jets.json");
  for (const Json::Value& v : root["cases"]) cases.push_back(read_case(v));
  return cases;
}

Body read_body175() {
  const Json::Value v = read_json("bodies.json")["body175"];
  const double sigma = 2 * number(v["spacing"]);
  Body body;
  for (const Json::Value& centre : v["centers"])
    add_particle(body.particles, vector(centre), Vec3::Zero(), sigma, 1.0);
  body.threshold = half_median_threshold(body.particles.position, body.particles.weight, sigma);
  return body;
}

Body read_body_of_seven() {
  const Json::Value v = read_json("bodies.json")["seven"];
  Body body;
  for (const Json::Value& p : v["particles"])
    add_particle(body.particles, vector(p["center"]), Vec3::Zero(), number(p["sigma"]), number(p["weight"]));
  body.threshold = number(v["threshold"]);
  return body;
}

}  // namespace kappaflow::testing

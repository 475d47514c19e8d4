// Derivatives of expressions against central differences of what muparser evaluates.
#include <catch2/catch.hpp>
#include <cmath>

#include "core/error.hpp"
#include "fields/expression.hpp"
#include "fields/expression_derivative.hpp"
#include "fields/mlp.hpp"
#include "fields/random.hpp"

using namespace jaxmpm;

namespace {

using Parameters = std::map<std::string, double>;

double value(const std::string& text, const std::array<double, 3>& place, const Parameters& parameters) {
  return Expression(text, 3, parameters, "/v").value(place);
}

}  // namespace

TEST_CASE("derivatives of expressions") {
  const Parameters parameters{{"a", 0.7}, {"b", -0.4}, {"a2", 1.5}};
  for (const char* text : {"a",
                           "b",
                           "2",
                           "a*x+b*y",
                           "a^2",
                           "-a^2",
                           "2^a^b",
                           "2^-a",
                           "-2^2*a",
                           "a-b-a*x",
                           "a/b/x",
                           "a/(b*x)",
                           "1e-3*a+2.5E+2*a*y",
                           "a2*a",
                           "sqrt(a*x)",
                           "sin(a*x)*cos(a)+tan(a)",
                           "asin(a)+acos(a)+atan(a*y)",
                           "sinh(a)+cosh(a)+tanh(a)+asinh(a)+acosh(a+2)+atanh(a)",
                           "exp(-a*x)",
                           "ln(a)+log(a)+log2(a)+log10(a)",
                           "atan2(a,x)",
                           "sum(a,a*x,2)+avg(a,a^3)",
                           "abs(x)*a",
                           "min(x,y)*a^2+max(x,y)",
                           "y<0.3 ? a*y : a^2",
                           "(y<0.3 && x>0.1 ? a*y : sqrt(a))^2*a",
                           "y > 0 ? (x > 0.5 ? a : a*a) : 7",
                           "sin(y>0.1 ? a*x : a)",
                           "(x<=y)*a+(x>=y)*a*a",
                           "_pi*a+_e*a^2",
                           "a^x",
                           "x^a",
                           "a*rint(x)",
                           "+a-(-a)*x",
                           "a * (x + y) ^ 2 / (1 + a)",
                           "y > 5 ? sqrt(y-5)*a : a"}) {
    const Expression slope(derivative_text(text, "a", "/v"), 3, parameters, "/v");
    for (const std::array<double, 3>& place : {std::array<double, 3>{0.2, 0.1, 0}, {0.6, 0.4, 0}, {1.3, 0.35, 0}}) {
      Parameters ahead = parameters, behind = parameters;
      ahead["a"] += 1e-5;
      behind["a"] -= 1e-5;
      INFO(text << " -> " << derivative_text(text, "a", "/v"));
      CHECK(slope.value(place) == Approx((value(text, place, ahead) - value(text, place, behind)) / 2e-5).epsilon(1e-8).margin(1e-9));
    }
  }
}

TEST_CASE("functions without a derivative are refused by name where the unknown is under them") {
  for (const auto& [text, name] : {std::pair{"abs(a)", "'abs'"},
                                   {"1+min(x,a*y)", "'min'"},
                                   {"x*(a<y)", "'<'"},
                                   {"a > 0 ? 1 : 2", "'>'"},
                                   {"sign(x-a)", "'sign'"},
                                   {"rint(y > 0 ? a : 1)", "'rint'"}}) {
    INFO(text);
    CHECK_THROWS_WITH(derivative_text(text, "a", "/bodies/0/velocity/0"), Catch::Contains(name) && Catch::Contains("'a'"));
  }
}

TEST_CASE("a network's derivatives by its weights") {
  for (const char* activation : {"tanh", "relu"}) {
    deck::Mlp description;
    description.inputs = {"x", "y"};
    description.hidden = {5, 4, 3};
    description.activation = activation;
    description.input_center = {0.1, -0.2};
    description.input_scale = {2, 3};
    description.output_scale = 1.5;
    description.seed = 4;
    description.weights = Mlp(description, 2, "/mlp").weights();
    RandomStream random(1);
    for (double& w : description.weights) w += 0.3 * random.normal();
    const std::array<double, 3> place{0.3, -0.4, 0};
    std::vector<double> exact(description.weights.size(), 0.25);
    Mlp(description, 2, "/mlp").add_gradient(place, 2, exact.data());
    for (std::size_t k = 0; k < exact.size(); ++k) {
      deck::Mlp ahead = description, behind = description;
      ahead.weights[k] += 1e-6;
      behind.weights[k] -= 1e-6;
      const double measured = (Mlp(ahead, 2, "/mlp").value(place) - Mlp(behind, 2, "/mlp").value(place)) / 2e-6;
      CHECK(exact[k] - 0.25 == Approx(2 * measured).epsilon(1e-7).margin(1e-8));
    }
  }
}

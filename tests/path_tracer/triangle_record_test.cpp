#include "firmware/path_tracer/geometry/triangle_record.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "firmware/path_tracer/geometry/triangle.hpp"
#include "tests/support/vectors.hpp"

namespace triangle_record_test {

using cn::poly;
using cn::vec3;
using path_tracer::kNoFace;
using path_tracer::TriangleRecord;
using test_support::kComponents;
using test_support::load;
using test_support::load3;
using test_support::PerPe;
using test_support::Ray;
using test_support::store;
using test_support::Vector;

double length(const Vector& v) {
  return std::hypot(v.x, v.y, v.z);
}

struct Shape {
  Vector vertex;
  Vector edge1;
  Vector edge2;

  Vector at(double u, double v) const { return vertex + edge1 * u + edge2 * v; }
};

template <class Source, class Member>
PerPe<Vector> all(const std::vector<Source>& sources, Member Source::*member) {
  PerPe<Vector> vectors;
  for (const Source& source : sources) vectors.push_back(source.*member);
  return vectors;
}

path_tracer::RayOperands operands(const std::vector<Ray>& rays) {
  return {load3(all(rays, &Ray::origin)), load3(all(rays, &Ray::direction)), kNoFace};
}

class TriangleRecordTest : public test_support::StripFixture {
 protected:
  TriangleRecordTest() : StripFixture(1024) {}

  double number(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }
  /// Returns a size between the two, uniform in its logarithm.
  double size(double least, double most) { return std::exp(number(std::log(least), std::log(most))); }
  Vector point(double scale) { return {number(-scale, scale), number(-scale, scale), number(-scale, scale)}; }
  Vector unit() {
    while (true) {
      const Vector v = point(1.0);
      if (length(v) > 0.1) return v * (1 / length(v));
    }
  }
  bool one_in(unsigned count) { return random_() % count == 0; }

  /// Returns a triangle about as flat as the loader accepts: height 1e-12 of the longest edge.
  Shape any_shape(double scale) {
    Shape shape{point(scale), point(size(1e-9, 1.0) * scale), {}};
    const Vector across = cross(unit(), shape.edge1);
    const double height = one_in(2) ? size(2e-12, 1.0) : 1.0;
    shape.edge2 = shape.edge1 * (one_in(2) ? 1.0 : number(-1.0, 1.0)) + across * height;
    if (one_in(4)) {  // in a plane across an axis
      double Vector::*const axis = kComponents[random_() % 3];
      shape.edge1.*axis = shape.edge2.*axis = 0.0;
    }
    return shape;
  }
  /// Returns a point on the triangle, its edges and vertices, or just beside them.
  Vector target(const Shape& shape) {
    double u = number(0, 1);
    double v = number(0, 1);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    if (one_in(3)) (one_in(2) ? u : v) = 0.0;
    if (one_in(4)) u = 1 - v;
    if (one_in(6)) u = v = 0.0;
    Vector to = shape.at(u, v);
    if (one_in(2)) to = to + unit() * (size(1e-18, 1e-12) * length(to));
    return to;
  }
  /// Returns a ray towards the target, from anywhere or nearly along the plane.
  Ray any_ray(const Shape& shape, double scale) {
    const Vector to = target(shape);
    Vector from = point(scale);
    if (one_in(2)) {
      const Vector along = shape.edge1 * number(-1, 1) + shape.edge2 * number(-1, 1);
      from = to + along * (scale * size(1e-3, 1.0) / length(along)) + unit() * (scale * size(1e-18, 1e-6));
    }
    for (double Vector::*component : kComponents)
      if (one_in(8)) from.*component = to.*component;  // a direction without this component
    const double stretch = one_in(2) ? 1.0 : size(1e-3, 1e3);
    return {from, (to - from) * (stretch / scale)};
  }

  std::mt19937_64 random_{53};
};

struct Outcome {
  PerPe<char> accepted;
  PerPe<char> certain;
  PerPe<char> box_met;  ///< and not behind the hit
};

/// One ray and one triangle for each PE.
class PaddedBoxes : public TriangleRecordTest {
 protected:
  struct Case {
    Shape shape;
    TriangleRecord record;
    Ray ray;
  };

  std::vector<Case> cases(double scale, double reach) {
    std::vector<Case> cases;
    while (int(cases.size()) < num_pes()) {
      const Shape shape = any_shape(scale);
      if (!(length(cross(shape.edge1, shape.edge2)) > 0)) continue;
      const Ray ray = one_in(2) ? any_ray(shape, scale) : hardly_certain(shape, scale, reach);
      if (length(ray.direction) > 0)
        cases.push_back({shape,
                         path_tracer::triangle_record(shape.vertex, shape.edge1, shape.edge2, {0, 0, reach}),
                         ray});
    }
    return cases;
  }

  /// Returns a ray that grazes the triangle or its padding, at about the angle from which on hits are
  /// certain.
  Ray hardly_certain(const Shape& shape, double scale, double reach) {
    const double padding = path_tracer::padded_box(shape.vertex, shape.edge1, shape.edge2, reach).padding;
    const Vector normal = cross(shape.edge1, shape.edge2);
    const double least = path_tracer::kRoundings * (reach / padding) * length(shape.edge1) *
                         length(shape.edge2) / length(normal);
    const Vector along = shape.edge1 * number(-1, 1) + shape.edge2 * number(-1, 1);
    const double sine = std::min(0.9, least * size(0.5, 8));
    const Vector back = along * (1 / length(along)) + normal * (sine / length(normal));
    Vector to = target(shape);
    if (one_in(2)) to = to + unit() * (padding * size(0.1, 4));
    return {to + back * (scale * size(1e-3, 1.0)), back * -1.0};
  }

  Outcome try_all(const std::vector<Case>& cases, double reach) {
    std::vector<Shape> shapes;
    std::vector<TriangleRecord> records;
    std::vector<Ray> rays;
    PerPe<Vector> lower, upper;
    for (const Case& c : cases) {
      shapes.push_back(c.shape);
      records.push_back(c.record);
      rays.push_back(c.ray);
      const auto box = path_tracer::padded_box(c.shape.vertex, c.shape.edge1, c.shape.edge2, reach);
      lower.push_back(box.lower);
      upper.push_back(box.upper);
    }
    Outcome outcome{per_pe<char>(), per_pe<char>(), per_pe<char>()};
    run([&] {
      const path_tracer::RayOperands ray = operands(rays);
      const path_tracer::PolyTriangle triangle{load3(all(records, &TriangleRecord::vertex)),
                                               load3(all(records, &TriangleRecord::edge1)),
                                               load3(all(records, &TriangleRecord::edge2)),
                                               load3(all(records, &TriangleRecord::back)),
                                               0,
                                               0};
      const path_tracer::Crossing crossing(ray, triangle);
      const path_tracer::Slabs slabs =
          path_tracer::BoxRay(ray.origin, ray.direction).slabs(load3(lower), load3(upper));
      const auto latest = path_tracer::latest_entry(crossing.distance / crossing.size);
      store(outcome.accepted, crossing.inside);
      store(outcome.certain, is_certain(crossing.determinant, ray));
      const auto met = (slabs.entry <= slabs.exit) & (slabs.entry <= latest);
      store(outcome.box_met, met);
      check_own_test(ray, reach, crossing, triangle, met);
    });
    return outcome;
  }

 private:
  /// The firmware makes the box from the record; it must be the same.
  void check_own_test(const path_tracer::RayOperands& ray, double reach,
                      const path_tracer::Crossing& crossing, const path_tracer::PolyTriangle& triangle,
                      const cn::mask& met) {
    PerPe<char> own = per_pe<char>();
    PerPe<char> expected = per_pe<char>();
    store(own, crossing.inside & meets_padded_box(ray, reach, crossing, triangle));
    store(expected, crossing.inside & met);
    EXPECT_EQ(own, expected);
  }
};

/// The claim at the top of triangle_record.hpp.
TEST_F(PaddedBoxes, AreMetByEveryHitThatIsCertain) {
  int certain = 0;
  int uncertain = 0;
  int uncertain_outside = 0;
  for (const double scale : {1e-70, 1e-5, 1.0, 3e4, 1e70}) {
    for (int round = 0; round < 40; ++round) {
      const double reach = 8 * scale;  // origins and vertices lie within a cube of 4 about
      const std::vector<Case> tried = cases(scale, reach);
      const Outcome outcome = try_all(tried, reach);
      ASSERT_FALSE(HasFailure());
      for (std::size_t pe = 0; pe < tried.size(); ++pe) {
        if (!outcome.accepted[pe]) continue;
        ++(outcome.certain[pe] ? certain : uncertain);
        uncertain_outside += !outcome.certain[pe] && !outcome.box_met[pe];
        ASSERT_TRUE(outcome.box_met[pe] || !outcome.certain[pe]) << "scale " << scale << " round " << round;
      }
    }
  }
  EXPECT_GT(certain, 40000);
  EXPECT_GT(uncertain, 1000);
  EXPECT_GT(uncertain_outside, 50) << "otherwise the test would prove nothing";
}

/// A power of two as a factor of edges and `back` changes no bit of an answer. So a record can be scaled
/// until certainty is a comparison with the direction alone.
TEST_F(TriangleRecordTest, ScalesEdgesAndBackByOnePowerOfTwo) {
  for (int i = 0; i < 10000; ++i) {
    const double scale = size(1e-70, 1e70);
    const Shape shape = any_shape(scale);
    const double reach = 8 * scale;
    const double factor = path_tracer::record_scale(shape.vertex, shape.edge1, shape.edge2, reach);
    int exponent = 0;
    ASSERT_EQ(std::frexp(factor, &exponent), 0.5);
    const TriangleRecord record =
        path_tracer::triangle_record(shape.vertex, shape.edge1, shape.edge2, {3, 4, reach});
    ASSERT_EQ(record.edge1.x, shape.edge1.x * factor);
    ASSERT_EQ(record.edge2.z, shape.edge2.z * factor);
    ASSERT_EQ(record.face, 3);
    ASSERT_EQ(record.number, 4);
    // |determinant| >= 64 e reach |edge1| |edge2| / padding, for a direction of length 1
    const double padding = path_tracer::padded_box(shape.vertex, shape.edge1, shape.edge2, reach).padding;
    const long double least = path_tracer::kRoundings * reach *
                              static_cast<long double>(length(shape.edge1)) * length(shape.edge2) / padding *
                              factor;
    ASSERT_LE(least, 1.0L);
    ASSERT_GE(least, 0.24L) << "a larger power of two would do";
  }
}

/// The result of a search, to the bit.
struct Answer {
  PerPe<std::int32_t> number;
  PerPe<double> distance;
  PerPe<double> determinant;

  bool operator==(const Answer& other) const {
    const auto same = [](const PerPe<double>& a, const PerPe<double>& b) {
      return std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
    };
    return number == other.number && same(distance, other.distance) && same(determinant, other.determinant);
  }
};

class SearchOrder : public TriangleRecordTest {
 protected:
  /// Searches in runs of that many triangles, as leaves come.
  Answer search_runs(const std::vector<Ray>& rays, const std::vector<TriangleRecord>& triangles, double reach,
                     int run_length) {
    Answer answer{per_pe<std::int32_t>(), per_pe<double>(), per_pe<double>()};
    run([&] {
      path_tracer::Nearest nearest;
      const path_tracer::RayOperands ray = operands(rays);
      for (int first = 0; first < int(triangles.size()); first += run_length)
        search(ray, reach,
               path_tracer::MonoTriangles{&triangles[std::size_t(first)],
                                          std::min(run_length, int(triangles.size()) - first)},
               nearest);
      store(answer.number, nearest.number);
      store(answer.distance, nearest.distance);
      store(answer.determinant, nearest.determinant);
    });
    return answer;
  }

  static std::vector<TriangleRecord> numbered(const std::vector<Shape>& shapes, double reach) {
    std::vector<TriangleRecord> records;
    for (const Shape& shape : shapes) {
      const auto number = std::int32_t(records.size());
      records.push_back(
          path_tracer::triangle_record(shape.vertex, shape.edge1, shape.edge2, {number % 5, number, reach}));
    }
    return records;
  }

  /// @return how many PEs found something
  int expect_the_same_in_every_order(const std::vector<Shape>& shapes, double scale) {
    const double reach = 8 * scale;
    std::vector<Ray> rays;
    while (int(rays.size()) < num_pes()) {
      rays.push_back(any_ray(shapes[random_() % shapes.size()], scale));
      if (!(length(rays.back().direction) > 0)) rays.pop_back();
    }
    std::vector<TriangleRecord> records = numbered(shapes, reach);
    const Answer first = search_runs(rays, records, reach, int(records.size()));
    for (int order = 0; order < 24; ++order) {
      std::shuffle(records.begin(), records.end(), random_);
      EXPECT_EQ(search_runs(rays, records, reach, 1 + order % 5), first);
    }
    return int(
        std::count_if(first.number.begin(), first.number.end(), [](int number) { return number >= 0; }));
  }
};

TEST_F(SearchOrder, DoesNotMatterAmongAnyTriangles) {
  int hits = 0;
  for (const double scale : {1e-70, 1.0, 1e70}) {
    for (int round = 0; round < 4; ++round) {
      std::vector<Shape> shapes;
      for (int i = 0; i < 12; ++i) shapes.push_back(any_shape(scale));
      hits += expect_the_same_in_every_order(shapes, scale);
      ASSERT_FALSE(HasFailure()) << scale;
    }
  }
  EXPECT_GT(hits, 4000);
}

TEST_F(SearchOrder, DoesNotMatterAmongDuplicates) {
  for (int round = 0; round < 4; ++round) {
    const Shape shape = any_shape(1.0);
    // The same triangle from each of its vertices and wound the other way: equal but for rounding.
    const Shape turned{shape.at(1, 0), shape.edge2 - shape.edge1, shape.edge1 * -1.0};
    const Shape back{shape.vertex, shape.edge2, shape.edge1};
    expect_the_same_in_every_order({shape, turned, back, shape, turned, back, shape}, 1.0);
    ASSERT_FALSE(HasFailure());
  }
}

/// A fan around one vertex, in one plane, and a folded one.
TEST_F(SearchOrder, DoesNotMatterAtSharedEdgesAndVertices) {
  for (int round = 0; round < 6; ++round) {
    const Vector middle = point(0.5);
    const Vector u = point(0.5);
    const Vector v = point(0.5);
    const auto rim = [&](int i) {
      const double angle = i * 0.7;
      const Vector fold = round % 2 == 0 ? Vector{0, 0, 0} : cross(u, v) * (i % 2);
      return middle + u * std::cos(angle) + v * std::sin(angle) + fold;
    };
    std::vector<Shape> fan;
    for (int i = 0; i < 9; ++i) fan.push_back({middle, rim(i) - middle, rim(i + 1) - middle});
    expect_the_same_in_every_order(fan, 1.0);
    ASSERT_FALSE(HasFailure());
  }
}

/// Triangles in one plane, one over the other, so that distances differ by rounding only.
TEST_F(SearchOrder, DoesNotMatterAmongCoplanarTriangles) {
  for (int round = 0; round < 6; ++round) {
    const Vector origin = point(0.5);
    const Vector u = round % 2 == 0 ? Vector{1, 0, 0} : unit();
    const Vector v = round % 2 == 0 ? Vector{0, 0, 1} : unit();
    std::vector<Shape> shapes;
    for (int i = 0; i < 12; ++i)
      shapes.push_back({origin + u * number(-0.1, 0.1) + v * number(-0.1, 0.1),
                        u * number(-1, 1) + v * number(-1, 1), u * number(-1, 1) + v * number(-1, 1)});
    expect_the_same_in_every_order(shapes, 1.0);
    ASSERT_FALSE(HasFailure());
  }
}

}  // namespace triangle_record_test

#include "dvi/align/align.h"

#include "dvi/align/joint.h"
#include "dvi/align/paper_search.h"

namespace dvi::align {

Cameras::Cameras(const Views& given) : views(given.size()) {
  for (const View& view : given.views) camera_from_world.push_back(view.camera_from_world);
}

double get_expected_rotation_deg(const AlignOptions& options, Sensor sensor) {
  return options.rotation_deg.value_or(sensor == Sensor::depth_camera ? 0.5 : 0.1);
}

double get_expected_position_m(Sensor sensor) { return sensor == Sensor::depth_camera ? 0.01 : 0; }

Cameras align(const Views& views, const map::VisibleMap& map, const AlignOptions& options, const Tick& tick) {
  Cameras out(views);
  if (!options.enabled) return out;
  for (int sequence = 0; sequence < views.sequences(); ++sequence) {
    const auto [first, last] = views.of_sequence(sequence);
    AlignOptions adapted = options;
    if (first != last) adapted.rotation_deg = get_expected_rotation_deg(options, views[first].sensor);
    if (first == last) {
      out.sequences.emplace_back();
    } else if (options.method == AlignMethod::paper) {
      search_as_published({views, map, first, last}, options, tick, out);
      out.sequences.push_back({.kept = true});
    } else {
      align_jointly({views, map, first, last}, adapted, tick, out);
    }
  }
  return out;
}

std::size_t count_align_ticks(const Views& views, const AlignOptions& options) {
  constexpr std::size_t kPasses = 3;  // passes of the joint method
  if (!options.enabled) return 0;
  return views.size() * (options.method == AlignMethod::paper ? 1 : kPasses);
}

}  // namespace dvi::align

#include "dvi/objects/detect/description.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/drive/traffic_classes.h"

namespace dvi::objects {
namespace {

// Objects that are removed to protect people, beside traffic.
const std::set<std::string, std::less<>>& private_classes() {
  static const std::set<std::string, std::less<>> names{"face",          "head",          "plate",
                                                        "license plate", "license-plate", "license_plate",
                                                        "number plate",  "number_plate",  "numberplate"};
  return names;
}

// Takes the size of the input from its declared shape.
void add_declared_size(const OnnxFile& file, Description& out) {
  const auto is_size = [](const TensorInfo& input) { return input.type == ElementType::int64; };
  const auto image = std::find_if_not(file.inputs.begin(), file.inputs.end(), is_size);
  const auto sizes = std::count_if(file.inputs.begin(), file.inputs.end(), is_size);
  const bool is_only_image = image != file.inputs.end() && sizes <= 1 && std::ssize(file.inputs) == sizes + 1;
  const std::size_t rank = is_only_image ? image->shape.size() : 0;
  const bool has_channels = rank == 3 || rank == 4 ? image->shape[rank - 3] <= 3 : rank == 0;
  if (!is_only_image || !has_channels)
    throw InputError(file.path, fmt::format("takes {}, which is not an image of 1x3xHxW", format_shapes(file.inputs)),
                     "export the network with an image as its only input (docs/detector.md)");
  if (sizes > 0) out.fit = Fit::stretch;  // as the networks with such an input are trained
  if (image->shape.empty()) return;
  const std::int64_t height = image->shape[image->shape.size() - 2], width = image->shape.back();
  if (height > 0 && width > 0) out.input = {static_cast<int>(width), static_cast<int>(height)};
}

}  // namespace

void choose_classes(const std::set<std::string, std::less<>>& names, Description& out) {
  out.removed.clear();
  for (const std::string& name : out.classes) out.removed.push_back(names.contains(name) ? 1 : 0);
  if (std::count(out.removed.begin(), out.removed.end(), 1) == 0)
    throw InputError(out.model,
                     fmt::format("none of its classes is removed; it has {}",
                                 fmt::join(out.classes.begin(), out.classes.begin() + std::min(out.class_count(), 20), ", ")),
                     "choose some with --classes, or with 'remove' in MODEL.toml (docs/detector.md)");
}

Description describe_network(const OnnxFile& file) {
  Description out;
  out.model = file.path;
  out.files = {file.path};
  out.files.insert(out.files.end(), file.weight_files.begin(), file.weight_files.end());
  add_declared_size(file, out);
  const cv::Size declared = out.input;
  add_exporter_metadata(file, out);
  const fs::path toml = fs::path(file.path).replace_extension(".toml");
  if (fs::exists(toml)) add_model_toml(toml, out);
  if (!declared.empty() && out.input != declared)
    throw InputError(toml,
                     fmt::format("[input] 'size' is {}x{}, but the network takes images of {}x{} (width x height)",
                                 out.input.width, out.input.height, declared.width, declared.height),
                     "correct or remove it");
  if (out.classes.empty()) return out;
  std::set<std::string, std::less<>> names = out.chosen;
  if (names.empty()) {
    names = traffic_classes();
    names.insert(private_classes().begin(), private_classes().end());
  }
  choose_classes(names, out);
  return out;
}

}  // namespace dvi::objects

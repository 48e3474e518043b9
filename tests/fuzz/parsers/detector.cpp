#include "dvi/objects/detect/description.h"
#include "parser.h"

// MODEL.toml, or the names of classes in the metadata of a network, which begin with a brace.
void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  objects::OnnxFile file{folder / "net.onnx", {{"images", objects::ElementType::float32, {1, 3, -1, -1}}}, {}, {}, {}};
  if (bytes.starts_with('{'))
    file.metadata["names"] = bytes;
  else
    put(folder / "net.toml", bytes);
  const objects::Description read = objects::describe_network(file);
  require(read.removed.size() == read.classes.size(), "every class is removed or not");
  require(read.sigma[0] > 0, "images can be brought to the input");
}

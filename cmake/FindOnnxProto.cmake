# The messages of the ONNX format (Debian's libonnx-dev) as the imported target onnx::proto.
include(FindPackageHandleStandardArgs)
find_path(ONNX_INCLUDE_DIR onnx/onnx_pb.h)
find_library(ONNX_PROTO_LIBRARY onnx_proto)
find_library(PROTOBUF_LIBRARY protobuf)
find_package_handle_standard_args(OnnxProto REQUIRED_VARS ONNX_INCLUDE_DIR ONNX_PROTO_LIBRARY PROTOBUF_LIBRARY)
if(OnnxProto_FOUND AND NOT TARGET onnx::proto)
  add_library(onnx::proto UNKNOWN IMPORTED)
  set_target_properties(onnx::proto PROPERTIES
    IMPORTED_LOCATION ${ONNX_PROTO_LIBRARY}
    INTERFACE_LINK_LIBRARIES ${PROTOBUF_LIBRARY}
    INTERFACE_SYSTEM_INCLUDE_DIRECTORIES ${ONNX_INCLUDE_DIR}
    INTERFACE_INCLUDE_DIRECTORIES ${ONNX_INCLUDE_DIR})
endif()

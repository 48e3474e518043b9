#pragma once

#include <optional>

#include <nlohmann/json.hpp>

/// Converts an optional to its value or to null. Only .cpp files that write or read a document include this header.
template <class T>
struct nlohmann::adl_serializer<std::optional<T>> {
  static void to_json(nlohmann::json& json, const std::optional<T>& value) {
    json = value ? nlohmann::json(*value) : nlohmann::json();
  }
};

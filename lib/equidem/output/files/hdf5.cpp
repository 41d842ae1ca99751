// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/hdf5.hpp"

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>

#include <hdf5.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// An identifier of the library, closed at the end; negative where the call that made it failed.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close_call)(hid_t)) : id_(id), close_(close_call) {}
  ~Handle() { close(); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  operator hid_t() const { return id_; }
  [[nodiscard]] bool failed() const { return id_ < 0; }
  bool close() {
    const hid_t id = std::exchange(id_, -1);
    return id < 0 || close_(id) >= 0;
  }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Errors are returned, not printed. Files are not locked, so that other programs can read them during a run.
Handle file_access() {
  H5dont_atexit();  // its clean-up at the end of the process crashes where a file could not be closed: disk full
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_file_locking(access, false, true);
  return {access, H5Pclose};
}

Handle number_type(Hdf5Number number, std::uint64_t length) {
  switch (number) {
    case Hdf5Number::float64:
      return {H5Tcopy(H5T_NATIVE_DOUBLE), H5Tclose};
    case Hdf5Number::int64:
      return {H5Tcopy(H5T_NATIVE_INT64), H5Tclose};
    case Hdf5Number::text:
      break;
  }
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, std::max<std::uint64_t>(length, 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return {type, H5Tclose};
}

bool write_attribute(hid_t owner, const std::string& name, const std::string& value) {
  const Handle type = number_type(Hdf5Number::text, value.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(owner, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return H5Awrite(attribute, type, value.c_str()) >= 0;
}

/// \return its offset in the HDF5 part of the file; none where it failed
std::optional<std::uint64_t> create_array(hid_t file, const Hdf5Array& array) {
  const bool text = array.number == Hdf5Number::text;
  const Handle type = number_type(array.number, text ? array.bytes() : 0);
  const std::vector<hsize_t> shape(array.shape.begin(), array.shape.end());
  const Handle space(
      text ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_layout(creation, H5D_CONTIGUOUS);
  H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);
  H5Pset_obj_track_times(creation, false);
  const Handle data(H5Dcreate2(file, array.name.c_str(), type, space, links, creation, H5P_DEFAULT), H5Dclose);
  if (data.failed()) return std::nullopt;
  if (array.bytes() == 0) return 0;
  const haddr_t offset = H5Dget_offset(data);
  if (offset == HADDR_UNDEF) return std::nullopt;
  return offset;
}

[[noreturn]] void cannot_lay_out(const std::filesystem::path& path) {
  computation_failed(
      fmt::format("cannot write '{}'", path.string()), "the HDF5 library failed to make it",
      "Make room on its disk, and check that its folder can be written to; a run goes on from its last checkpoint");
}

[[noreturn]] void cannot_use(const std::filesystem::path& path, const std::string& why) {
  bad_input(fmt::format("cannot use '{}'", path.string()), why, "Give the file as equidem wrote it");
}

std::string read_text_attribute(hid_t attribute, hid_t type) {
  std::string value(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, value.data()) < 0) value.clear();
  return value.substr(0, value.find('\0'));
}

std::map<std::string, std::string> read_text_attributes(hid_t file) {
  std::map<std::string, std::string> attributes;
  const auto collect = [](hid_t owner, const char* name, const H5A_info_t*, void* into) -> herr_t {
    const Handle attribute(H5Aopen(owner, name, H5P_DEFAULT), H5Aclose);
    const Handle type(H5Aget_type(attribute), H5Tclose);
    if (H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0) {
      (*static_cast<std::map<std::string, std::string>*>(into))[name] = read_text_attribute(attribute, type);
    }
    return 0;
  };
  H5Aiterate2(file, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &attributes);
  return attributes;
}

std::optional<Hdf5Number> number_of(hid_t type) {
  if (H5Tequal(type, H5T_NATIVE_DOUBLE) > 0) return Hdf5Number::float64;
  if (H5Tequal(type, H5T_NATIVE_INT64) > 0) return Hdf5Number::int64;
  if (H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0) return Hdf5Number::text;
  return std::nullopt;
}

Hdf5Array find_array(const std::filesystem::path& path, hid_t file, const std::string& name) {
  const Handle data(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (data.failed()) cannot_use(path, fmt::format("it has no array '{}'", name));
  const Handle type(H5Dget_type(data), H5Tclose);
  const Handle space(H5Dget_space(data), H5Sclose);
  const std::optional<Hdf5Number> number = number_of(type);
  if (!number) cannot_use(path, fmt::format("its array '{}' holds no numbers of a type of this machine", name));
  Hdf5Array array{.name = name, .number = *number, .shape = {}};
  const int rank = H5Sget_simple_extent_ndims(space);
  std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(rank, 0)));
  H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  array.shape.assign(shape.begin(), shape.end());
  if (*number == Hdf5Number::text) array.shape = {H5Tget_size(type)};
  if (array.bytes() == 0) return array;
  const haddr_t offset = H5Dget_offset(data);
  if (offset == HADDR_UNDEF) cannot_use(path, fmt::format("its array '{}' does not lie in one piece", name));
  array.offset = offset;
  return array;
}

}  // namespace

std::uint64_t Hdf5Array::size() const {
  std::uint64_t count = 1;
  for (const std::uint64_t extent : shape) count *= extent;
  return count;
}

std::uint64_t Hdf5Array::bytes() const {
  return number == Hdf5Number::text ? size() : 8 * size();
}

const Hdf5Array& Hdf5Layout::operator[](const std::string& name) const {
  const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const Hdf5Array& a) { return a.name == name; });
  assert(found != arrays.end());
  return *found;
}

Hdf5Layout write_hdf5_layout(const std::filesystem::path& path, Hdf5Layout layout) {
  const Handle access = file_access();
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_userblock(creation, layout.user_block);
  Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access), H5Fclose);
  if (file.failed()) cannot_lay_out(path);
  for (const auto& [name, value] : layout.attributes) {
    if (!write_attribute(file, name, value)) cannot_lay_out(path);
  }
  for (Hdf5Array& array : layout.arrays) {
    const auto offset = create_array(file, array);
    if (!offset) cannot_lay_out(path);
    array.offset = *offset;
  }
  if (!file.close()) cannot_lay_out(path);
  return layout;
}

Hdf5Layout read_hdf5_layout(const std::filesystem::path& path, const std::vector<std::string>& names) {
  const Handle access = file_access();
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose);
  if (file.failed()) cannot_use(path, "the HDF5 library cannot open it");
  Hdf5Layout layout;
  const Handle creation(H5Fget_create_plist(file), H5Pclose);
  hsize_t user_block = 0;
  H5Pget_userblock(creation, &user_block);
  layout.user_block = user_block;
  layout.attributes = read_text_attributes(file);
  for (const std::string& name : names) layout.arrays.push_back(find_array(path, file, name));
  return layout;
}

}  // namespace equidem

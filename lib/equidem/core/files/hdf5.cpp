// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/files/hdf5.hpp"

#include <algorithm>
#include <cassert>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include <hdf5.h>

#include "equidem/core/error.hpp"
#include "equidem/core/files/open_file.hpp"
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
    case Hdf5Number::int32:
      return {H5Tcopy(H5T_NATIVE_INT32), H5Tclose};
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

/// No times, so that the same layout gives the same bytes; links in a heap, which the library can list without sorting.
void set_up_group(hid_t creation) {
  H5Pset_obj_track_times(creation, false);
  H5Pset_link_phase_change(creation, 0, 0);
}

/// Make the groups of "groups/left/discs" that do not exist yet.
bool create_groups_of(hid_t file, const std::string& name, hid_t links) {
  const Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  set_up_group(creation);
  for (std::size_t end = name.find('/'); end != std::string::npos; end = name.find('/', end + 1)) {
    const std::string group = name.substr(0, end);
    if (H5Lexists(file, group.c_str(), H5P_DEFAULT) > 0) continue;
    const Handle made(H5Gcreate2(file, group.c_str(), links, creation, H5P_DEFAULT), H5Gclose);
    if (made.failed()) return false;
  }
  return true;
}

/// \return its offset in the HDF5 part of the file; none where it failed
std::optional<std::uint64_t> create_array(hid_t file, const Hdf5Array& array) {
  const bool text = array.number == Hdf5Number::text;
  const Handle type = number_type(array.number, text ? array.bytes() : 0);
  const std::vector<hsize_t> shape(array.shape.begin(), array.shape.end());
  const Handle space(
      text ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_char_encoding(links, H5T_CSET_UTF8);
  if (!create_groups_of(file, array.name, links)) return std::nullopt;
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_layout(creation, H5D_CONTIGUOUS);
  H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);
  H5Pset_obj_track_times(creation, false);
  const Handle data(H5Dcreate2(file, array.name.c_str(), type, space, links, creation, H5P_DEFAULT), H5Dclose);
  if (data.failed()) return std::nullopt;
  for (const auto& [name, value] : array.attributes) {
    if (!write_attribute(data, name, value)) return std::nullopt;
  }
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

/// The text of an attribute, also of variable length as other programs write it; none where it holds something else.
std::optional<std::string> read_text_attribute(hid_t attribute) {
  constexpr std::size_t longest = 1 << 20;  // bytes
  const Handle type(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) return std::nullopt;
  if (H5Tis_variable_str(type) > 0) {
    const Handle in_memory(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(in_memory, H5T_VARIABLE);
    H5Tset_cset(in_memory, H5Tget_cset(type));
    char* text = nullptr;
    if (H5Aread(attribute, in_memory, static_cast<void*>(&text)) < 0 || text == nullptr) return std::nullopt;
    std::string value(text);
    H5free_memory(text);
    return value;
  }
  const std::size_t length = H5Tget_size(type);
  if (length > longest) return std::nullopt;
  std::string value(length, '\0');
  if (H5Aread(attribute, type, value.data()) < 0) value.clear();
  return value.substr(0, value.find('\0'));
}

std::map<std::string, std::string> read_text_attributes(hid_t file) {
  std::map<std::string, std::string> attributes;
  const auto collect = [](hid_t owner, const char* name, const H5A_info_t*, void* into) -> herr_t {
    const Handle attribute(H5Aopen(owner, name, H5P_DEFAULT), H5Aclose);
    if (attribute.failed()) return 0;
    if (auto text = read_text_attribute(attribute))
      (*static_cast<std::map<std::string, std::string>*>(into))[name] = std::move(*text);
    return 0;
  };
  H5Aiterate2(file, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &attributes);
  return attributes;
}

std::optional<Hdf5Number> number_of(hid_t type) {
  if (H5Tequal(type, H5T_NATIVE_DOUBLE) > 0) return Hdf5Number::float64;
  if (H5Tequal(type, H5T_NATIVE_INT32) > 0) return Hdf5Number::int32;
  if (H5Tequal(type, H5T_NATIVE_INT64) > 0) return Hdf5Number::int64;
  if (H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0) return Hdf5Number::text;
  return std::nullopt;
}

std::vector<std::uint64_t> shape_of(hid_t space) {
  std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(H5Sget_simple_extent_ndims(space), 0)));
  H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  return {shape.begin(), shape.end()};
}

Hdf5Array find_array(const std::filesystem::path& path, hid_t file, const std::string& name) {
  const Handle data(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (data.failed()) cannot_use(path, fmt::format("it has no array '{}'", name));
  const Handle type(H5Dget_type(data), H5Tclose);
  const Handle space(H5Dget_space(data), H5Sclose);
  const std::optional<Hdf5Number> number = number_of(type);
  if (!number) cannot_use(path, fmt::format("its array '{}' holds no numbers of a type of this machine", name));
  Hdf5Array array{.name = name, .number = *number, .shape = shape_of(space)};
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
  switch (number) {
    case Hdf5Number::text:
      return size();
    case Hdf5Number::int32:
      return 4 * size();
    case Hdf5Number::int64:
    case Hdf5Number::float64:
      break;
  }
  return 8 * size();
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
  set_up_group(creation);
  // From version 1.8 on the structure of a file has checksums; the library may crash on one that is damaged.
  H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_LATEST);
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

Hdf5File::Hdf5File(std::filesystem::path path) : path_(std::move(path)) {
  static_assert(sizeof(hid_t) == sizeof(id_));
  constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
  std::string beginning(signature.size(), '\0');
  const OpenFile bytes(path_, OpenFile::Mode::read);
  beginning.resize(std::min<std::uint64_t>(beginning.size(), bytes.size()));
  bytes.read_at(0, std::as_writable_bytes(std::span(beginning)));
  if (beginning != signature) {
    bad_input("this is no HDF5 file", "it does not begin with the signature of one",
              "Give the file as it was written; other formats have other endings");
  }
  const Handle access = file_access();
  id_ = H5Fopen(path_.c_str(), H5F_ACC_RDONLY, access);
  if (id_ < 0) {
    bad_input("the HDF5 library cannot open the file", "it is truncated or damaged",
              "Get the whole file, or write it anew");
  }
  attributes_ = read_text_attributes(id_);
}

Hdf5File::~Hdf5File() {
  if (id_ >= 0) H5Fclose(id_);
}

std::vector<std::string> Hdf5File::names(const std::string& group) const {
  std::vector<std::string> found;
  const Handle owner(H5Gopen2(id_, group.c_str(), H5P_DEFAULT), H5Gclose);
  if (owner.failed()) return found;
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* into) -> herr_t {
    static_cast<std::vector<std::string>*>(into)->emplace_back(name);
    return 0;
  };
  // In the order of the file: a sorted list of links crashes the library (1.10) where one of them is damaged.
  if (H5Literate(owner, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, collect, &found) < 0)
    bad_input_at(group, "the HDF5 library cannot list what this group holds", "the file is truncated or damaged",
                 "Get the whole file, or write it anew");
  std::sort(found.begin(), found.end());
  return found;
}

bool Hdf5File::is_group(const std::string& name) const {
  const Handle object(H5Oopen(id_, name.c_str(), H5P_DEFAULT), H5Oclose);
  return !object.failed() && H5Iget_type(object) == H5I_GROUP;
}

std::optional<Hdf5File::Dataset> Hdf5File::find(const std::string& name) const {
  const Handle object(H5Oopen(id_, name.c_str(), H5P_DEFAULT), H5Oclose);
  if (object.failed() || H5Iget_type(object) != H5I_DATASET) return std::nullopt;
  const Handle type(H5Dget_type(object), H5Tclose);
  const Handle space(H5Dget_space(object), H5Sclose);
  const H5T_class_t held = H5Tget_class(type);
  return Dataset{.kind = held == H5T_FLOAT     ? Kind::real
                         : held == H5T_INTEGER ? Kind::whole
                                               : Kind::other,
                 .shape = shape_of(space)};
}

void Hdf5File::read_rows(const std::string& name, std::uint64_t first, std::span<double> values) const {
  read_rows_as(H5T_NATIVE_DOUBLE, name, first, values.size(), values.data());
}

void Hdf5File::read_rows(const std::string& name, std::uint64_t first, std::span<std::int64_t> values) const {
  read_rows_as(H5T_NATIVE_INT64, name, first, values.size(), values.data());
}

void Hdf5File::read_rows_as(std::int64_t type, const std::string& name, std::uint64_t first, std::size_t count,
                            void* values) const {
  const Handle data(H5Dopen2(id_, name.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle space(H5Dget_space(data), H5Sclose);
  const std::vector<std::uint64_t> shape = shape_of(space);
  std::vector<hsize_t> begin(shape.size(), 0), extent(shape.begin(), shape.end());
  std::uint64_t row = 1;
  for (std::size_t k = 1; k < shape.size(); ++k) row *= shape[k];
  assert(!shape.empty() && row > 0 && count % row == 0 && first + count / row <= shape[0]);
  if (count == 0) return;
  begin[0] = first;
  extent[0] = count / row;
  const Handle in_memory(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose);
  H5Sselect_hyperslab(space, H5S_SELECT_SET, begin.data(), nullptr, extent.data(), nullptr);
  if (H5Dread(data, type, in_memory, space, H5P_DEFAULT, values) >= 0) return;
  bad_input_at(name, "the HDF5 library cannot read this dataset",
               "the file is truncated, damaged or compressed in a way "
               "that the library lacks",
               "Get the whole file, or write it anew");
}

}  // namespace equidem

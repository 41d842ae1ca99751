// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Binding of the keys of a file to the members of options structs.
///
/// To add a key: add a member with its default value to the options struct (the file that uses it), and one line to the
/// table of the file:
///
///   file.table("solver", &Case::solver, completed, "how the equations are solved")
///       .keys({key("method", &SolverOptions::method, "auto: multifrontal"),
///              key("max_refinements", &SolverOptions::max_refinements, from(0, 100), "refinement steps")});
///
/// Checks, messages, `help case`, the reference page, --set, the echo and the reading follow from that line. The type
/// of the member is the type of the key: bool a flag, an integer a whole number, double a number, Vec2 [x, y],
/// std::string text, std::filesystem::path a file (relative to the case file), an enum with names its choices,
/// std::vector a list. The value of the member in a default-constructed struct is the default of the key; a
/// std::optional has none. Members of members are given as a chain: key("columns", &AssemblyCase::lattice,
/// &LatticeOptions::columns).
///
/// A key that applies to some kinds of its table only has the attribute `when`; one that another key excludes, replaces
/// or needs has `not_beside`, `or_instead` or `only_with`. What several tables must fulfil together is checked by the
/// function that completes the case.
///
/// A table is bound to a struct (required or completed), to a std::optional of one (absent: no value) or to a
/// std::vector of them ([[table]]).
#pragma once

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/engine/toml.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/vector.hpp"

namespace equidem::casefile {

template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;
template <class T>
inline constexpr bool is_vector = false;
template <class T>
inline constexpr bool is_vector<std::vector<T>> = true;

template <class T>
inline constexpr bool is_pair_of_names = std::same_as<T, std::array<std::string, 2>>;

/// A rectangle, [x_min, y_min, x_max, y_max].
template <class T>
concept BoxLike = requires(T box) {
  Vec2{box.low}, Vec2{box.high};
};
/// A disc, [x, y, radius].
template <class T>
concept CircleLike = requires(T circle) {
  Vec2{circle.offset}, double{circle.radius};
};

template <class T>
constexpr KeyType type_of_key() {
  if constexpr (is_optional<T>) {
    return type_of_key<typename T::value_type>();
  } else if constexpr (is_vector<T>) {
    using Item = typename T::value_type;
    if constexpr (std::same_as<Item, std::int32_t>)
      return KeyType::discs;
    else if constexpr (std::integral<Item>)
      return KeyType::sizes;
    else if constexpr (std::floating_point<Item>)
      return KeyType::numbers;
    else if constexpr (CircleLike<Item>)
      return KeyType::circles;
    else
      return KeyType::words;
  } else if constexpr (is_pair_of_names<T>) {
    return KeyType::two_names;
  } else if constexpr (std::same_as<T, bool>) {
    return KeyType::flag;
  } else if constexpr (std::integral<T>) {
    return KeyType::whole;
  } else if constexpr (std::floating_point<T>) {
    return KeyType::number;
  } else if constexpr (std::is_enum_v<T>) {
    return KeyType::choice;
  } else if constexpr (std::same_as<T, Vec2>) {
    return KeyType::vector;
  } else if constexpr (BoxLike<T>) {
    return KeyType::box;
  } else if constexpr (std::same_as<T, std::filesystem::path>) {
    return KeyType::path;
  } else {
    static_assert(std::same_as<T, std::string>);
    return KeyType::text;
  }
}

/// Names of the values of an enum; none for other types.
template <class T>
std::vector<std::string> choices_of() {
  if constexpr (is_optional<T>)
    return choices_of<typename T::value_type>();
  else if constexpr (NamedEnum<T>)
    return names_of<T>();
  else
    return {};
}

/// A default as TOML; `none` for a std::optional without a value.
template <class T>
std::string default_text(const T& value) {
  if constexpr (is_optional<T>) {
    return value ? default_text(*value) : KeySpec::none;
  } else if constexpr (is_vector<T>) {
    std::string list;
    for (const auto& item : value) list += (list.empty() ? "" : ", ") + default_text(item);
    return "[" + list + "]";
  } else if constexpr (std::same_as<T, bool>) {
    return value ? "true" : "false";
  } else if constexpr (std::integral<T>) {
    return std::to_string(value);
  } else if constexpr (std::floating_point<T>) {
    return toml_number(value);
  } else if constexpr (std::is_enum_v<T>) {
    return toml_text(to_string(value));
  } else if constexpr (std::same_as<T, Vec2>) {
    return "[" + toml_number(value.x) + ", " + toml_number(value.y) + "]";
  } else if constexpr (std::same_as<T, std::string>) {
    return toml_text(value);
  } else {
    return KeySpec::none;  // files, boxes, circles
  }
}

/// The number of a checked value: `true` is 0 (KeyType::held), text is bytes.
double number_of(const TomlValue& value);
/// The path of a checked value, resolved against the folder of the file; the value is replaced by it.
std::filesystem::path path_of(TomlValue& value, const std::filesystem::path& folder);

/// A checked value as a T. "auto" leaves `result` as it is (a std::optional: without a value), unless it is a name of
/// the enum.
template <class T>
void assign(T& result, TomlValue& value, const std::filesystem::path& folder) {
  if constexpr (is_optional<T>) {
    typename T::value_type read{};
    const bool automatic = value.type == TomlValue::Type::text && value.text == "auto";
    result.reset();
    if constexpr (NamedEnum<typename T::value_type>) {
      if (automatic) return;
    } else if constexpr (std::floating_point<typename T::value_type>) {
      if (automatic) return;
    }
    assign(read, value, folder);
    result = std::move(read);
  } else if constexpr (is_vector<T>) {
    result.clear();
    for (TomlValue& item : value.items) assign(result.emplace_back(), item, folder);
  } else if constexpr (is_pair_of_names<T>) {
    result = {value.items[0].text, value.items[1].text};
  } else if constexpr (std::same_as<T, bool>) {
    result = value.boolean;
  } else if constexpr (std::integral<T>) {
    result = static_cast<T>(value.integer);
  } else if constexpr (std::floating_point<T>) {
    if (value.type != TomlValue::Type::text || value.text != "auto") result = number_of(value);
  } else if constexpr (std::is_enum_v<T>) {
    result = enum_from<T>(value.text);
  } else if constexpr (std::same_as<T, Vec2>) {
    result = {value.items[0].real, value.items[1].real};
  } else if constexpr (BoxLike<T>) {
    result.low = {value.items[0].real, value.items[1].real};
    result.high = {value.items[2].real, value.items[3].real};
  } else if constexpr (CircleLike<T>) {
    result.offset = {value.items[0].real, value.items[1].real};
    result.radius = value.items[2].real;
  } else if constexpr (std::same_as<T, std::filesystem::path>) {
    result = path_of(value, folder);
  } else {
    result = value.text;
  }
}

/// Throw an Error (bad_input) that names the line of a value, and its key.
[[noreturn]] inline void fail_at(const TomlValue& at, const std::string& problem, const std::string& why,
                                 const std::string& remedy) {
  bad_input_at(at.place(), problem, why, remedy);
}

/// The place of a key of a table, which it may lack.
std::string place_of(const TomlValue& table, const std::string& key);

/// Likewise, of a key of a table.
[[noreturn]] inline void fail_at(const TomlValue& table, const std::string& key, const std::string& problem,
                                 const std::string& why, const std::string& remedy) {
  bad_input_at(place_of(table, key), problem, why, remedy);
}

/// The result of a step; its Error gets a place, unless it has one.
template <class Step>
auto with_place(const std::string& where, const Step& step) {
  try {
    return step();
  } catch (const Error& error) {
    throw error.at(where);
  }
}

/// The result of a step; its Error gets the line of that key of the table.
template <class Step>
auto with_key(const TomlValue& table, const char* key, const Step& step) {
  return with_place(place_of(table, key), step);
}

/// The result of a step of the library: its Error, whose place may be the name of an option, gets the line of that key
/// of the table, or of the table.
/// \param usual the key of an Error without a place; empty: that of the table
template <class Step>
auto at_key(const TomlValue& table, const Step& step, const std::string& usual = {}) {
  try {
    return step();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    const std::string& option = error.where().empty() ? usual : error.where();
    const TomlValue* key = option.empty() ? nullptr : table.find(option);
    throw Error(error.kind(), error.problem(), error.why(), error.remedy(), (key == nullptr ? table : *key).place());
  }
}

/// The tables of a list such as [[load]]; empty if there are none.
const std::vector<TomlValue>& repeated(const TomlValue& root, const char* name);

/// A path of the file, resolved against its folder.
std::filesystem::path opened(const std::filesystem::path& written, const std::filesystem::path& folder);

/// \throws Error (bad_input) where two tables of a list have one name, or a name is empty
void check_names(const TomlValue& root, const char* list);

/// \param what "a load case"
/// \param use "it becomes part of the names of files"
/// \throws Error (bad_input) where the text holds more than letters, digits, '_' and '-'
void check_plain_name(const TomlValue& value, const std::string& what, const std::string& use);

/// \throws Error (bad_input) where the corners of a box are not in ascending order
void check_box(const TomlValue& given, Vec2 low, Vec2 high);

/// A member of an object, or of the value of a std::optional, which is given one if it is empty.
template <class S, class M, class C>
auto& member(S& object, M C::*link) {
  if constexpr (is_optional<S>) {
    if (!object) object.emplace();
    return (*object).*link;
  } else {
    return object.*link;
  }
}

/// Attributes of keys and tables, given after the member; a text is the help.
struct Required {
  void operator()(KeySpec& key) const { key.fallback = KeySpec::required; }
  void operator()(TableSpec& table) const { table.required = true; }
};
inline constexpr Required required;
/// If the key is absent, the member keeps its value and the echo omits the key.
inline constexpr auto optional = [](KeySpec& key) { key.fallback = KeySpec::none; };
/// The default of a key that is bound to a function.
template <class T>
auto by_default(const T& value) {
  return [text = default_text(value)](KeySpec& key) { key.fallback = text; };
}
/// The default is "auto", which leaves the member as it is.
inline constexpr auto or_auto = [](KeySpec& key) {
  key.fallback = "\"auto\"";
  if (key.type == KeyType::number) key.type = KeyType::number_or_auto;
  if (key.type == KeyType::choice) key.choices.insert(key.choices.begin(), "auto");
};
/// A number, or true for 0.
inline constexpr auto held = [](KeySpec& key) { key.type = KeyType::held; };
inline constexpr auto bytes = [](KeySpec& key) {
  key.type = KeyType::bytes;
  key.unit = "bytes";
};
/// A missing table is added with its defaults.
inline constexpr auto completed = [](TableSpec& table) { table.completed = true; };
/// The table has keys of another one, for what differs.
inline auto like(std::string table) {
  return [table](TableSpec& spec) { spec.like = table; };
}
/// A table [[name]] that is read elsewhere.
inline constexpr auto repeated_table = [](TableSpec& table) { table.repeated = true; };
inline auto range(Range range) {
  return [range](KeySpec& key) { key.range = range; };
}
inline const auto positive = range(Range::positive());
inline const auto not_negative = range(Range::not_negative());
inline const auto not_zero = range({.zero_excluded = true});
/// Both ends included.
inline auto from(double low, double high) {
  return range(Range::from(low, high));
}
/// Both ends excluded.
inline auto between(double low, double high) {
  return range({.low = low, .high = high, .low_open = true, .high_open = true});
}
inline auto unit(std::string text) {
  return [text](KeySpec& key) { key.unit = text; };
}
/// [] is a list of words too.
inline constexpr auto or_empty = [](KeySpec& key) { key.may_be_empty = true; };
inline auto refused(std::vector<RefusedWord> words) {
  return [words](KeySpec& key) { key.refused = words; };
}
/// Words of a text or of a list, or the names of an enum that are allowed here.
inline auto choices(std::vector<std::string> words) {
  return [words](KeySpec& key) {
    key.choices = words;
    if (key.type == KeyType::text) key.type = KeyType::choice;
  };
}
/// The key, or the table, applies only where the key `selector` of its table (of another one: "assembly.kind") is one
/// of these words.
inline auto when(std::string selector, std::vector<std::string> words) {
  return [selector, words](auto& spec) {
    spec.when_key = selector;
    spec.when = words;
  };
}

/// The key is one of the files of these kinds alone; of others that bind its table it is refused with a reason.
inline auto only_in(std::vector<CaseKind> kinds) {
  return [kinds](KeySpec& key) { key.kinds = kinds; };
}

/// Relations to other keys, or tables, of the table; `why` is the reason in messages.
inline auto related(KeyRelation::Kind kind, std::vector<std::string> others, std::string why) {
  return [relation = KeyRelation{kind, std::move(others), std::move(why)}](KeySpec& key) {
    key.relations.push_back(relation);
    if (relation.kind == KeyRelation::Kind::exactly_one) key.fallback = KeySpec::none;
  };
}
/// Exactly one of the key and the others is given.
inline auto or_instead(std::vector<std::string> others, std::string why) {
  return related(KeyRelation::Kind::exactly_one, std::move(others), std::move(why));
}
/// At most one of the key and the others is given.
inline auto not_beside(std::vector<std::string> others, std::string why) {
  return related(KeyRelation::Kind::at_most_one, std::move(others), std::move(why));
}
/// The key is given beside one of the others only.
inline auto only_with(std::vector<std::string> others, std::string why) {
  return related(KeyRelation::Kind::only_with, std::move(others), std::move(why));
}

template <class Spec, class Attribute>
void attach(Spec& spec, const Attribute& attribute) {
  attribute(spec);
}
template <class Spec>
void attach(Spec& spec, const std::string& help) {
  spec.help = help;
}
template <class Spec>
void attach(Spec& spec, const char* help) {
  spec.help = help;
}
template <class Spec, class M, class C>
void attach(Spec& /*spec*/, M C::*const& /*link*/) {}

/// The function from an object to its member at the end of a chain. Its type tells the types of the members, not which
/// they are: keys of one type in one struct share their code.
struct Itself {
  template <class S>
  S& operator()(S& object) const {
    return object;
  }
};
template <class Before, class M, class C>
struct MemberOf {
  Before before;
  M C::*link;

  template <class S>
  auto& operator()(S& object) const {
    return member(before(object), link);
  }
};
/// The chain is at the head of the arguments.
template <class Before, class... Arguments>
Before follower(Before before, const Arguments&... /*attributes*/) {
  return before;
}
template <class Before, class M, class C, class... Arguments>
auto follower(Before before, M C::*const& next, const Arguments&... arguments) {
  return follower(MemberOf<Before, M, C>{before, next}, arguments...);
}

/// One key of a table that is bound to an S.
template <class S>
struct Key {
  KeySpec spec;
  std::function<void(S&, TomlValue&, const std::filesystem::path&)> read = {};
};

/// A key that is checked and described, and read elsewhere.
template <class S, class... Attributes>
Key<S> unbound_key(std::string name, KeyType type, Attributes... attributes) {
  Key<S> key{.spec = {.table = {}, .name = std::move(name), .type = type, .fallback = KeySpec::none}};
  (attach(key.spec, attributes), ...);
  return key;
}

/// A key bound to a function that takes a T; it has no default.
template <class S, class T, class... Attributes>
Key<S> key_with(std::string name, void (*set)(S&, const T&), Attributes... attributes) {
  Key<S> key = unbound_key<S>(std::move(name), type_of_key<T>());
  key.spec.choices = choices_of<T>();
  key.read = [set](S& object, TomlValue& value, const std::filesystem::path& folder) {
    T given{};
    assign(given, value, folder);
    set(object, given);
  };
  (attach(key.spec, attributes), ...);
  return key;
}

template <class S, class Target>
Key<S> key_of_member(std::string name, const Target& target) {
  S defaults{};
  using T = std::remove_cvref_t<decltype(target(defaults))>;
  Key<S> key = unbound_key<S>(std::move(name), type_of_key<T>());
  key.spec.fallback = default_text(target(defaults));
  key.spec.choices = choices_of<T>();
  key.read = [target](S& object, TomlValue& value, const std::filesystem::path& folder) {
    assign(target(object), value, folder);
  };
  return key;
}

/// A key bound to the member of an S at the end of a chain; then its attributes.
template <class S, class... Arguments>
Key<S> key_in(std::string name, Arguments... arguments) {
  Key<S> key = key_of_member<S>(std::move(name), follower(Itself(), arguments...));
  (attach(key.spec, arguments), ...);
  return key;
}

template <class S, class M, class... Arguments>
Key<S> key(std::string name, M S::*first, Arguments... arguments) {
  return key_in<S>(std::move(name), first, arguments...);
}

/// The keys of a member, as keys of the whole.
template <class S, class M>
std::vector<Key<S>> keys_of_member(M S::*link, const std::vector<Key<M>>& keys) {
  std::vector<Key<S>> all;
  for (const Key<M>& key : keys) {
    all.push_back({key.spec});
    if (key.read)
      all.back().read = [link, read = key.read](S& object, TomlValue& value, const std::filesystem::path& folder) {
        read(object.*link, value, folder);
      };
  }
  return all;
}

/// Assign the keys that a checked table has; its paths, relative to a folder, become those that the program opens.
template <class S>
void read_table_in_place(const std::vector<Key<S>>& keys, TomlValue& table, const std::filesystem::path& folder,
                         S& into) {
  for (const Key<S>& key : keys)
    if (TomlValue* value = table.find(key.spec.name); value != nullptr && key.read) key.read(into, *value, folder);
}

/// Likewise, of a table without paths.
template <class S>
void read_table(const std::vector<Key<S>>& keys, TomlValue table, S& into) {
  read_table_in_place(keys, table, {}, into);
}

template <class T>
struct ItemOf {
  using type = T;
};
template <class T>
requires(is_optional<T> || is_vector<T>) struct ItemOf<T> {
  using type = typename T::value_type;
};

/// The schema of all case files.
inline constexpr const char* case_schema = "equidem/1";

/// A kind of file, bound to an F that is a CaseDocument.
template <class F>
class File {
 public:
  File(std::string schema, std::string noun, CaseKind kind) : spec_{std::move(schema), std::move(noun), kind} {
    const std::string help = "says which rules the file follows: \"" + spec_.schema + "\"";
    table("").keys({unbound_key<F>("schema", KeyType::text, required, help),
                    key_in<F>("title", &CaseDocument::title, "shown in reports and pictures")});
  }

  template <class Target>
  class Binder;

  /// A table, bound to the member at the end of a chain, without one to the F itself; then its attributes. Its keys are
  /// given to the result.
  template <class... Arguments>
  auto table(std::string name, Arguments... arguments) {
    const auto target = follower(Itself(), arguments...);
    TableSpec spec{.name = std::move(name)};
    (attach(spec, arguments), ...);
    return Binder<decltype(target)>(*this, std::move(spec), target);
  }
  [[nodiscard]] const FileSpec& spec() const { return spec_; }
  /// How the message on an unknown key finds files of other kinds that have it.
  void ask(std::vector<CaseKind> (*kinds_with)(std::string_view path)) { spec_.kinds_with = kinds_with; }

  /// Check a document, fill in its defaults and assign its values.
  /// \param folder to which paths are relative; those of the document become the paths that the program opens
  /// \throws Error (bad_input) as check_and_complete
  F read(TomlValue& root, const std::filesystem::path& folder) const {
    F into;
    const auto enter = [&](const TableSpec& table) {
      for (const auto& [name, open] : openers_)
        if (name == table.name) open(into);
    };
    const auto assign = [&](const KeySpec& key, TomlValue& value) {
      if (const auto& read = readers_[static_cast<std::size_t>(&key - spec_.keys.data())]) read(into, value, folder);
    };
    check_and_complete(root, spec_, {.table = enter, .key = assign});
    return into;
  }

 private:
  FileSpec spec_;
  std::vector<std::pair<std::string, std::function<void(F&)>>> openers_;  ///< by table: gives its target a value
  std::vector<std::function<void(F&, TomlValue&, const std::filesystem::path&)>> readers_;  ///< of spec_.keys
};

template <class F>
template <class Target>
class File<F>::Binder {
  using T = std::remove_cvref_t<decltype(std::declval<Target>()(std::declval<F&>()))>;
  using Item = typename ItemOf<T>::type;

 public:
  Binder(File& file, TableSpec spec, Target target) : file_(file), spec_(std::move(spec)), target_(target) {
    spec_.repeated = spec_.repeated || is_vector<T>;
  }

  /// Keys that are checked and described here, and read elsewhere.
  template <class S>
  void described(const std::vector<Key<S>>& keys) {
    for (const Key<S>& key : keys) describe(key.spec);
  }
  /// A table that holds other tables alone.
  void holds_tables() { file_.spec_.tables.push_back(spec_); }

  void keys(const std::vector<Key<Item>>& keys) { bind(keys); }
  /// Binds keys of a base of the struct.
  template <class Base>
  void keys(const std::vector<Key<Base>>& keys) {
    bind(keys);
  }

 private:
  template <class S>
  void bind(const std::vector<Key<S>>& keys) {
    if constexpr (is_vector<T>) {
      file_.openers_.emplace_back(spec_.name, [target = target_](F& into) { target(into).emplace_back(); });
    } else if constexpr (is_optional<T>) {
      file_.openers_.emplace_back(spec_.name, [target = target_](F& into) {
        if (auto& bound = target(into); !bound) bound.emplace();
      });
    }
    for (const Key<S>& key : keys) {
      if (!describe(key.spec) || !key.read) continue;
      file_.readers_.back() = [read = key.read, target = target_](F& into, TomlValue& value,
                                                                  const std::filesystem::path& folder) {
        if constexpr (is_vector<T>)
          read(target(into).back(), value, folder);
        else if constexpr (is_optional<T>)
          read(*target(into), value, folder);
        else
          read(target(into), value, folder);
      };
    }
  }

  /// \return whether files of this kind have the key
  bool describe(KeySpec key) {
    key.table = spec_.name;
    if (!key.kinds.empty() && std::ranges::find(key.kinds, file_.spec_.kind) == key.kinds.end()) {
      file_.spec_.others.push_back(std::move(key));
      return false;
    }
    const auto is_selector = [&](const KeySpec& other) {
      return other.table == key.table && other.name == key.when_key;
    };
    if (std::ranges::any_of(file_.spec_.others, is_selector)) key.when_key.clear(), key.when.clear();
    file_.spec_.keys.push_back(std::move(key));
    file_.readers_.emplace_back();
    if (!spec_.name.empty() && file_.spec_.table(spec_.name) == nullptr) file_.spec_.tables.push_back(spec_);
    return true;
  }

  File& file_;
  TableSpec spec_;
  Target target_;
};

}  // namespace equidem::casefile

#include "deck/document.hpp"

#include <algorithm>
#include <iterator>
#include <list>
#include <optional>

namespace jaxmpm::deck {

using described::join;
using described::Json;

namespace {

/// How far the parser has read: its lexer is one character ahead after a number and exact after everything else.
struct Progress {
  int line = 1;
  char last = 0;
  int line_of_number() const { return last == '\n' ? line - 1 : line; }
};

/// Input iterator over the text that counts lines as it goes.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;
  CountingIterator(const char* at, Progress* progress) : at_(at), progress_(progress) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    progress_->last = *at_++;
    if (progress_->last == '\n') ++progress_->line;
    return *this;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  Progress* progress_;
};

/// Builds the tree and the lines from the parser's events.
class Builder : public nlohmann::json_sax<Json> {
 public:
  Builder(const Progress& progress, std::map<std::string, int>& lines, std::vector<Problem>& problems)
      : progress_(progress), lines_(lines), problems_(problems) {}

  Json root;
  std::optional<Problem> syntax;

  bool null() override { return place(nullptr, progress_.line); }
  bool boolean(bool value) override { return place(value, progress_.line); }
  bool number_integer(number_integer_t value) override { return place(value, progress_.line_of_number()); }
  bool number_unsigned(number_unsigned_t value) override { return place(value, progress_.line_of_number()); }
  bool number_float(number_float_t value, const string_t&) override { return place(value, progress_.line_of_number()); }
  bool string(string_t& value) override { return place(value, progress_.line); }
  bool binary(binary_t&) override { return false; }  // never in text
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    Level& level = levels_.back();
    level.key = name;
    const std::string at = join(level.pointer, name);
    if (level.value->contains(name)) {
      const auto first = lines_.find(at);
      problems_.push_back({at, progress_.line,
                           "the key is given twice" +
                               (first == lines_.end() ? std::string() : ", first on line " + std::to_string(first->second)) +
                               "; remove one of them"});
    } else {
      lines_.emplace(at, progress_.line);
    }
    return true;
  }

  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& error) override {
    std::string message = error.what();  // "[json.exception.… ] parse error at line 3, column 11: …"
    for (const char* lead : {"] ", "parse error at line "})
      if (const auto end = message.find(lead); end != std::string::npos) message.erase(0, end + std::string(lead).size());
    if (const auto column = message.find("column "); column != std::string::npos) message.erase(0, column);
    constexpr int number_overflow = 406;
    if (error.id == number_overflow) message += ": no quantity of a scene is so large; correct it";
    else message = "not valid JSON: " + message + "; correct the text here (NaN and Infinity are no JSON)";
    syntax = Problem{pointer(), progress_.line, message};
    return false;
  }

 private:
  struct Level {
    Json* value;
    std::string pointer;
    std::string key;  // the last one read, of an object
  };

  std::string pointer() const {
    if (levels_.empty()) return {};
    const Level& level = levels_.back();
    if (level.value->is_array()) return join(level.pointer, std::to_string(level.value->size()));
    return level.key.empty() ? level.pointer : join(level.pointer, level.key);
  }
  Json* insert(Json value, int line) {
    if (levels_.empty()) return &(root = std::move(value));
    const std::string at = pointer();
    Level& level = levels_.back();
    if (level.value->is_array()) {
      lines_.emplace(at, line);
      level.value->push_back(std::move(value));
      return &level.value->back();
    }
    if (level.value->contains(level.key)) return &(discarded_.emplace_back() = std::move(value));
    return &((*level.value)[level.key] = std::move(value));
  }
  bool place(Json value, int line) {
    insert(std::move(value), line);
    return true;
  }
  bool open(Json value) {
    constexpr std::size_t deepest = 100;  // no deck needs more; the readers above go down by recursion
    const std::string at = pointer();
    if (levels_.size() >= deepest) {
      syntax = Problem{"", progress_.line, "objects and lists are nested more than " + std::to_string(deepest) + " deep; remove some"};
      return false;
    }
    levels_.push_back({insert(std::move(value), progress_.line), at, {}});
    return true;
  }
  bool close() {
    levels_.pop_back();
    return true;
  }

  const Progress& progress_;
  std::map<std::string, int>& lines_;
  std::vector<Problem>& problems_;
  std::vector<Level> levels_;
  std::list<Json> discarded_;  // values of duplicate keys
};

/// Splits "/a/b~1c" into its unescaped parts.
std::vector<std::string> parts_of(const std::string& pointer) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at < pointer.size();) {
    const std::size_t next = std::min(pointer.find('/', at + 1), pointer.size());
    std::string part = pointer.substr(at + 1, next - at - 1);
    for (const auto& [escape, letter] : {std::pair{"~1", "/"}, std::pair{"~0", "~"}})
      for (std::size_t found = 0; (found = part.find(escape, found)) != std::string::npos; ++found) part.replace(found, 2, letter);
    parts.push_back(part);
    at = next;
  }
  return parts;
}

/// The child of a value, or null: an object's key, or a list's item by its index.
Json* child(Json& value, const std::string& part) {
  if (value.is_object()) return value.contains(part) ? &value[part] : nullptr;
  if (!value.is_array() || part.empty() || part.size() > 9 || part.find_first_not_of("0123456789") != std::string::npos) return nullptr;
  const std::size_t index = std::stoul(part);
  return index < value.size() ? &value[index] : nullptr;
}

}  // namespace

Document Document::parse(const std::string& text) {
  Document document;
  Progress progress;
  Builder builder(progress, document.lines_, document.problems_);
  const CountingIterator first(text.data(), &progress), last(text.data() + text.size(), &progress);
  constexpr bool strict = true, ignore_comments = true;
  if (!Json::sax_parse(first, last, &builder, Json::input_format_t::json, strict, ignore_comments)) throw DeckError({*builder.syntax});
  document.root_ = std::move(builder.root);
  return document;
}

void Document::assign(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (assignment.empty() || assignment[0] != '/' || equals == std::string::npos || equals < 2) {
    problems_.push_back({"", 0, "--set " + assignment + ": write /pointer=value, for example /time/end=0.5"});
    return;
  }
  const std::string pointer = assignment.substr(0, equals), text = assignment.substr(equals + 1);
  Json value = text;
  try {
    Document parsed = parse(text);
    value = parsed.root_;
    for (Problem& p : parsed.problems_) problems_.push_back({pointer + p.pointer, 0, "--set " + assignment + ": " + p.message});
  } catch (const DeckError&) {  // no JSON: a string
  }

  std::vector<std::string> parts = parts_of(pointer);
  const std::string name = parts.back();
  parts.pop_back();
  Json* parent = &root_;
  std::string above;
  for (const std::string& part : parts) {
    Json* next = child(*parent, part);
    if (next == nullptr) {
      problems_.push_back({pointer, 0, "--set " + assignment + ": there is no " + join(above, part) + " in the deck; set that first"});
      return;
    }
    above = join(above, part);
    parent = next;
  }
  if (parent->is_object()) {
    (*parent)[name] = std::move(value);
  } else if (Json* item = child(*parent, name)) {
    *item = std::move(value);
  } else {
    const std::string have =
        parent->is_array() ? "a list of " + std::to_string(parent->size()) + ", numbered from 0" : described::shown(*parent);
    problems_.push_back({pointer, 0, "--set " + assignment + ": " + above + " is " + have + " and has no " + name});
    return;
  }
  for (auto it = lines_.lower_bound(pointer); it != lines_.end() && it->first.compare(0, pointer.size(), pointer) == 0;)
    it = it->first.size() == pointer.size() || it->first[pointer.size()] == '/' ? lines_.erase(it) : std::next(it);
  lines_[pointer] = 0;
}

int Document::line(const std::string& pointer) const {
  for (std::string at = pointer; !at.empty(); at.erase(at.rfind('/')))
    if (const auto found = lines_.find(at); found != lines_.end()) return found->second;
  return 1;
}

}  // namespace jaxmpm::deck

// The actions of an x3g program, in as little memory as a long print allows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace packmerger::s3g {

// Kept as places in the program's bytes, four bytes each.
class Actions {
 public:
  class Iterator {
   public:
    Iterator(const Actions& actions, std::size_t index) : actions_(&actions), index_(index) {}
    std::string_view operator*() const { return (*actions_)[index_]; }
    Iterator& operator++() {
      ++index_;
      return *this;
    }
    bool operator!=(const Iterator& other) const { return index_ != other.index_; }

   private:
    const Actions* actions_;
    std::size_t index_;
  };

  // `program` outlives the actions. Throws Error{kBadInput} as check_x3g().
  explicit Actions(std::string_view program);

  // Adds a build start of this name, and a build end, where the program has none.
  void complete(std::string_view build_name);

  std::size_t size() const { return places_.size() + lead() + (end_.empty() ? 0 : 1); }
  std::string_view operator[](std::size_t index) const;
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size()}; }

  // Bytes of the program that are done with this action.
  std::size_t done(std::size_t index) const;
  // What it holds beside the program.
  std::size_t bytes() const { return places_.capacity() * sizeof(std::uint32_t); }

 private:
  std::size_t lead() const { return start_.empty() ? 0 : 1; }
  bool holds(std::uint8_t code) const;

  std::string_view program_;
  std::vector<std::uint32_t> places_;
  std::string start_;  // of our own; empty where the program has one
  std::string end_;
};

}  // namespace packmerger::s3g

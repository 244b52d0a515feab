#pragma once

#include <cassert>
#include <cstddef>
#include <vector>

namespace gusset {

/// A list of what is wanted of all that is offered, built without branches: where no predictor can
/// foretell what is wanted, a mispredicted branch costs more than the write.
template <class T>
class Sieve {
 public:
  void Clear() { size_ = 0; }
  /// Makes room for so many more offers; to be called before them.
  void Expect(std::size_t offers) {
    if (size_ + offers > items_.size()) items_.resize(2 * (size_ + offers));
  }
  void Offer(const T& item, bool wanted) {
    assert(size_ < items_.size());
    items_[size_] = item;
    size_ += wanted;
  }
  std::size_t size() const { return size_; }
  const T& operator[](std::size_t i) const { return items_[i]; }

 private:
  std::vector<T> items_;
  std::size_t size_ = 0;
};

}  // namespace gusset

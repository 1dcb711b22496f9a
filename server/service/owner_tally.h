// What all owners share, and how much of it each has open right now: so that one of them cannot take it all from the others.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace standin {

/// Of `most` in all, what one owner may have: `share` (0..1] of it, at least one.
template <class Count>
[[nodiscard]] Count share_of(Count most, double share) {
  return std::max(Count{1}, static_cast<Count>(std::floor(share * static_cast<double>(most))));
}

class OwnerTally {
  struct Counts {
    std::mutex mutex;
    std::map<std::string, unsigned> by_owner;  // none is 0
    unsigned all = 0;
  };

 public:
  /// One that is open, for as long as it lives; it may outlive the tally.
  class Hold {
   public:
    Hold(std::shared_ptr<Counts> counts, std::string owner) : counts_(std::move(counts)), owner_(std::move(owner)) {
      const std::scoped_lock lock(counts_->mutex);
      ++counts_->by_owner[owner_];
      ++counts_->all;
    }
    ~Hold() {
      const std::scoped_lock lock(counts_->mutex);
      const auto mine = counts_->by_owner.find(owner_);
      if (--mine->second == 0) counts_->by_owner.erase(mine);
      --counts_->all;
    }
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;

   private:
    std::shared_ptr<Counts> counts_;
    std::string owner_;
  };

  [[nodiscard]] std::unique_ptr<Hold> hold(const std::string& owner) const { return std::make_unique<Hold>(counts_, owner); }
  [[nodiscard]] unsigned all() const {
    const std::scoped_lock lock(counts_->mutex);
    return counts_->all;
  }
  [[nodiscard]] unsigned of(const std::string& owner) const {
    const std::scoped_lock lock(counts_->mutex);
    const auto found = counts_->by_owner.find(owner);
    return found == counts_->by_owner.end() ? 0 : found->second;
  }

 private:
  std::shared_ptr<Counts> counts_ = std::make_shared<Counts>();
};

}  // namespace standin

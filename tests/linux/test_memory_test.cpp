// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// A board's memory test against memory that is broken the one way that Linux can break it: addresses that lead to the
/// same cell. Every pair of pages in turn.

extern "C" {
#include "memory_test.h"
#include "unity.h"
}

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>

extern "C" {
void setUp(void) {}
void tearDown(void) {}
}

namespace {

constexpr std::size_t pages = 6;
constexpr std::size_t page_bytes = 4096;

/// Pages of memory, of which one may be another's second face.
class Memory {
  public:
    Memory(std::size_t original, std::size_t copy) : file_(memfd_create("memory", 0)) {
        TEST_ASSERT_EQUAL_INT(0, ftruncate(file_, pages * page_bytes));
        at_ = static_cast<char *>(mmap(nullptr, pages * page_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0));
        TEST_ASSERT_TRUE(at_ != MAP_FAILED);
        void *const face = at_ + copy * page_bytes;
        TEST_ASSERT_TRUE(face == mmap(face, page_bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file_,
                                      static_cast<off_t>(original * page_bytes)));
    }
    ~Memory() {
        (void)munmap(at_, pages * page_bytes);
        (void)close(file_);
    }
    Memory(const Memory &) = delete;
    Memory &operator=(const Memory &) = delete;
    Memory(Memory &&) = delete;
    Memory &operator=(Memory &&) = delete;

    [[nodiscard]] bool passes() const {
        auto *const begin = reinterpret_cast<volatile std::uint32_t *>(at_);
        return elmopp_memory_test(begin, begin + pages * page_bytes / sizeof(std::uint32_t));
    }
    [[nodiscard]] bool is_zero() const {
        bool zero = true;
        for (std::size_t k = 0; k < pages * page_bytes; ++k) {
            zero = zero && at_[k] == 0;
        }
        return zero;
    }

  private:
    int file_;
    char *at_ = nullptr;
};

void test_good_memory_passes_and_is_zero() {
    const Memory memory(0, 0);
    TEST_ASSERT_TRUE(memory.passes());
    TEST_ASSERT_TRUE(memory.is_zero());
}

void test_two_addresses_of_one_cell_are_found() {
    for (std::size_t original = 0; original < pages; ++original) {
        for (std::size_t copy = 0; copy < pages; ++copy) {
            const Memory memory(original, copy);
            TEST_ASSERT_EQUAL(original == copy, memory.passes());
        }
    }
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_good_memory_passes_and_is_zero);
    RUN_TEST(test_two_addresses_of_one_cell_are_found);
    return UNITY_END();
}

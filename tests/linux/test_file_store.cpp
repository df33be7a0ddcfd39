// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

// A store in files: every call to the system fails in turn, or is the last before the power goes, with what was not yet
// on the disk lost. What is read back is the old image or the new one, and what was said to be kept is there.

#include "error.hpp"
#include "file_store.hpp"
#include "temporary_folder.hpp"

extern "C" {
#include "image_writer.h"
#include "unity.h"
}

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <thread>

void setUp(void) {}
void tearDown(void) {}

namespace {

namespace fs = std::filesystem;
using elmopp::BadRequest;
using elmopp::FileCalls;
using elmopp::FileStore;
using elmopp::StoreFolder;
using elmopp::TemporaryFolder;

constexpr std::uint32_t body_bytes = 400;
constexpr std::uint32_t image_bytes = 16 + body_bytes;
const elmopp_image_kind_t kind = {{0x54U, 0x45U, 0x53U, 0x54U}, 5U, body_bytes};
using Image = std::array<std::uint8_t, image_bytes>;

Image image_of(std::uint8_t value) {
    Image image{};
    std::fill(image.begin() + 16, image.end(), value);
    image_seal(image.data(), "TEST", 5U, body_bytes);
    return image;
}

/// A system whose calls fail, and a disk that has only what was asked to be on it.
struct Disk {
    int calls = 0;
    int failing = -1; ///< number of the call that fails
    int error = 0;    ///< ... with this errno
    bool cut = false; ///< ... as do all that follow: the power has gone
    std::map<int, std::string> open_files;
    bool folder_unsafe = false;          ///< it has names that are not yet on the disk
    std::map<std::string, off_t> unsafe; ///< files with bytes that are not yet on the disk, and where these end
};
Disk disk;

bool fails() {
    const int number = disk.calls++;
    const bool now = number == disk.failing || (disk.cut && disk.failing >= 0 && number > disk.failing);
    if (now) {
        errno = disk.error;
    }
    return now;
}

int open_it(const char *path, int flags, mode_t mode) {
    if (fails()) {
        return -1;
    }
    const int descriptor = ::open(path, flags, mode);
    disk.folder_unsafe = disk.folder_unsafe || (static_cast<unsigned>(flags) & static_cast<unsigned>(O_CREAT)) != 0;
    disk.open_files[descriptor] = path;
    return descriptor;
}

ssize_t write_it(int descriptor, const void *bytes, std::size_t length) {
    if (fails()) {
        return -1;
    }
    const ssize_t written = ::write(descriptor, bytes, std::max<std::size_t>(1, length / 3)); // never all at once
    disk.unsafe[disk.open_files.at(descriptor)] = ::lseek(descriptor, 0, SEEK_CUR);
    return written;
}

int fsync_it(int descriptor) {
    if (fails()) {
        return -1;
    }
    const std::string &path = disk.open_files.at(descriptor);
    disk.unsafe.erase(path);
    disk.folder_unsafe = disk.folder_unsafe && !fs::is_directory(path);
    return 0;
}

const FileCalls broken_calls{open_it, write_it, fsync_it};

/// What has become of bytes that were not asked to be on the disk, when the power goes: half of them are gone, and the
/// file ends there, or has zeros in their place.
enum class Loss { none, end, zeros };

void lose_what_was_not_on_the_disk(Loss loss) {
    for (const auto &[file, end] : disk.unsafe) {
        if (loss == Loss::end && static_cast<std::uintmax_t>(end) == fs::file_size(file)) {
            fs::resize_file(file, fs::file_size(file) / 2);
        } else if (loss == Loss::zeros) {
            std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
            stream.seekp(end / 2);
            stream << std::string(static_cast<std::size_t>(end - end / 2), '\0');
        }
    }
}

struct Opened {
    FileStore files;
    elmopp_store_t store{};

    explicit Opened(const fs::path &folder, const FileCalls &calls = elmopp::system_file_calls)
        : files(folder, "thing", image_bytes, calls) {
        const elmopp_store_medium_t medium = files.medium();
        elmopp_store_init(&store, &medium, &kind);
    }

    [[nodiscard]] unsigned content() const {
        const std::uint8_t *newest = elmopp_store_newest(&store);
        return newest == nullptr ? 0U : newest[16];
    }

    /// True if it says that it is kept.
    bool save(std::uint8_t value) {
        const Image image = image_of(value);
        const std::uint16_t before = store.saved;
        TEST_ASSERT_TRUE(elmopp_store_save(&store, image.data()));
        elmopp_store_order_t order{};
        while (elmopp_store_next(&store, &order)) {
            const elmopp_store_answer_t answer = files.carry_out(order);
            elmopp_store_answer(&store, answer);
            if (answer == ELMOPP_STORE_LATER) {
                std::this_thread::sleep_for(std::chrono::microseconds(50));
            }
        }
        return store.saved != before;
    }
};

/// To prepare what a test is about: nothing is asked to be on the disk.
const FileCalls quick_calls{elmopp::system_file_calls.open, elmopp::system_file_calls.write, [](int) { return 0; }};

void save_surely(const fs::path &folder, std::uint8_t value) {
    Opened opened(folder, quick_calls);
    TEST_ASSERT_TRUE(opened.save(value));
}

void test_what_was_saved_is_there_for_the_next_program() {
    const TemporaryFolder folder;
    TEST_ASSERT_EQUAL_UINT(0U, Opened(folder.path()).content());
    for (std::uint8_t value = 1; value <= 20; ++value) {
        save_surely(folder.path(), value);
        const Opened again(folder.path());
        TEST_ASSERT_EQUAL_UINT(value, again.content());
        const Image image = image_of(value);
        TEST_ASSERT_EQUAL_MEMORY(image.data(), elmopp_store_newest(&again.store), image_bytes);
    }
    TEST_ASSERT_EQUAL_INT(2, std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator{}));
}

void test_the_order_to_seal_is_put_off_until_the_disk_has_it_and_costs_no_time() {
    const TemporaryFolder folder;
    disk = Disk{};
    FileCalls slow = elmopp::system_file_calls;
    slow.fsync = [](int descriptor) {
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        return ::fsync(descriptor);
    };
    Opened opened(folder.path(), slow);
    const Image image = image_of(7);
    TEST_ASSERT_TRUE(elmopp_store_save(&opened.store, image.data()));
    elmopp_store_order_t order{};
    unsigned put_off = 0;
    while (elmopp_store_next(&opened.store, &order)) {
        const auto begun = std::chrono::steady_clock::now();
        const elmopp_store_answer_t answer = opened.files.carry_out(order);
        TEST_ASSERT_TRUE(std::chrono::steady_clock::now() - begun < std::chrono::milliseconds(100));
        put_off += answer == ELMOPP_STORE_LATER ? 1U : 0U;
        elmopp_store_answer(&opened.store, answer);
        if (answer == ELMOPP_STORE_LATER) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
    TEST_ASSERT_TRUE(put_off > 50U);
    TEST_ASSERT_EQUAL_UINT(7U, opened.content());
}

/// Each call in turn fails with this errno, once or as the last of all.
void try_every_call(int error, Loss loss) {
    const bool cut = loss != Loss::none;
    bool reached = true;
    for (int failing = 0; reached; ++failing) {
        const TemporaryFolder folder;
        save_surely(folder.path(), 1);
        save_surely(folder.path(), 2);
        disk = Disk{};
        disk.failing = failing;
        disk.error = error;
        disk.cut = cut;
        bool said_kept = false;
        {
            Opened opened(folder.path(), broken_calls);
            said_kept = opened.save(3);
            reached = disk.calls > failing;
            TEST_ASSERT_EQUAL(said_kept, opened.files.trouble().empty());
            TEST_ASSERT_EQUAL_UINT(said_kept ? 3U : 2U, opened.content());
        }
        if (cut) {
            lose_what_was_not_on_the_disk(loss);
        }
        Opened again(folder.path(), quick_calls);
        TEST_ASSERT_FALSE_MESSAGE(elmopp_store_is_damaged(&again.store), "a cut is no damage");
        const unsigned found = again.content();
        TEST_ASSERT_TRUE_MESSAGE(found == 2U || found == 3U, "neither");
        TEST_ASSERT_TRUE_MESSAGE(found == 3U || !said_kept, "what was said to be kept is not there");
        TEST_ASSERT_TRUE(again.save(4));
        TEST_ASSERT_EQUAL_UINT(4U, Opened(folder.path()).content());
    }
}

void test_a_full_disk_a_broken_one_or_one_without_permission_loses_nothing_whichever_call_it_is() {
    for (const int error : {ENOSPC, EIO, EACCES, EROFS}) {
        try_every_call(error, Loss::none);
    }
}

void test_a_loss_of_power_at_every_call_leaves_the_old_image_or_the_new_one() {
    try_every_call(EIO, Loss::end);
    try_every_call(EIO, Loss::zeros);
}

void test_what_is_said_to_be_kept_is_on_the_disk_with_its_name() {
    const TemporaryFolder folder;
    disk = Disk{};
    Opened opened(folder.path(), broken_calls);
    TEST_ASSERT_TRUE(opened.save(1));
    TEST_ASSERT_TRUE(disk.unsafe.empty());
    TEST_ASSERT_FALSE(disk.folder_unsafe);
}

void test_a_file_that_is_cut_or_changed_is_none() {
    const TemporaryFolder folder;
    save_surely(folder.path(), 1);
    save_surely(folder.path(), 2);
    const fs::path newest = folder.path() / "thing.1";
    fs::resize_file(newest, fs::file_size(newest) - 1);
    TEST_ASSERT_EQUAL_UINT(1U, Opened(folder.path()).content());
    Opened cut(folder.path());
    TEST_ASSERT_FALSE(elmopp_store_is_damaged(&cut.store));
    std::ofstream(newest) << "somebody's own";
    TEST_ASSERT_EQUAL_UINT(1U, Opened(folder.path()).content());
    save_surely(folder.path(), 3);
    TEST_ASSERT_EQUAL_UINT(3U, Opened(folder.path()).content());
    std::fstream changed(newest, std::ios::in | std::ios::out | std::ios::binary);
    changed.seekp(100);
    changed << 'x';
    changed.close();
    Opened damaged(folder.path());
    TEST_ASSERT_EQUAL_UINT(1U, damaged.content());
    TEST_ASSERT_TRUE(elmopp_store_is_damaged(&damaged.store));
}

template <typename Act> void expect_refused(const char *words, Act act) {
    try {
        act();
    } catch (const BadRequest &error) {
        TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(error.what(), words), error.what());
        return;
    }
    TEST_FAIL_MESSAGE(words);
}

void test_a_folder_that_is_none_or_another_programs_is_refused() {
    const TemporaryFolder folder;
    expect_refused("is no folder", [&] { const StoreFolder none(folder.path() / "none"); });
    std::ofstream(folder.path() / "file") << "x";
    expect_refused("is no folder", [&] { const StoreFolder none(folder.path() / "file"); });
    auto first = std::make_unique<StoreFolder>(folder.path());
    expect_refused("another controller's", [&] { const StoreFolder second(folder.path()); });
    first.reset();
    const StoreFolder third(folder.path());
    fs::create_directory(folder.path() / "thing.0");
    expect_refused("thing.0 cannot be read", [&] { const FileStore files(folder.path(), "thing", image_bytes); });
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_what_was_saved_is_there_for_the_next_program);
    RUN_TEST(test_the_order_to_seal_is_put_off_until_the_disk_has_it_and_costs_no_time);
    RUN_TEST(test_a_full_disk_a_broken_one_or_one_without_permission_loses_nothing_whichever_call_it_is);
    RUN_TEST(test_a_loss_of_power_at_every_call_leaves_the_old_image_or_the_new_one);
    RUN_TEST(test_what_is_said_to_be_kept_is_on_the_disk_with_its_name);
    RUN_TEST(test_a_file_that_is_cut_or_changed_is_none);
    RUN_TEST(test_a_folder_that_is_none_or_another_programs_is_refused);
    return UNITY_END();
}

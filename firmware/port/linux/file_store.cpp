// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "file_store.hpp"

#include "error.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <system_error>

namespace elmopp {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t sectors_of_files = 2;
constexpr std::uint32_t word_bytes = ELMOPP_STORE_WORD;
constexpr std::uint32_t blank_word = 0xFFFFFFFFU;
constexpr char blank_byte = '\xFF';
constexpr std::uint32_t mark_at = 2 * word_bytes; // of a slot, behind the number and its complement
constexpr mode_t file_mode = 0644;

std::string why(const std::string &what) {
    return what + ": " + std::generic_category().message(errno);
}

/// Writes bytes to the beginning of a file and gets them to the disk. Empty, or why not.
std::string write_all(const FileCalls &calls, const std::string &file, int flags, const std::vector<char> &bytes) {
    const int descriptor = calls.open(file.c_str(), flags, file_mode);
    if (descriptor < 0) {
        return why(file);
    }
    std::string trouble;
    for (std::size_t at = 0; at < bytes.size() && trouble.empty();) {
        const ssize_t written = calls.write(descriptor, bytes.data() + at, bytes.size() - at);
        if (written > 0) {
            at += static_cast<std::size_t>(written);
        } else if (written == 0 || errno != EINTR) {
            trouble = why(file);
        }
    }
    if (trouble.empty() && calls.fsync(descriptor) != 0) {
        trouble = why(file);
    }
    (void)::close(descriptor);
    return trouble;
}

/// The folder's own list of names to the disk.
std::string sync_folder(const FileCalls &calls, const std::string &folder) {
    const int descriptor = calls.open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC, 0);
    if (descriptor < 0) {
        return why(folder);
    }
    std::string trouble;
    if (calls.fsync(descriptor) != 0) {
        trouble = why(folder);
    }
    (void)::close(descriptor);
    return trouble;
}

/// The whole without its mark and, when that is on the disk, its beginning again with the mark: so a file that has a
/// mark and is not whole has been damaged, and was not cut while it was written.
std::string write_file(const FileCalls &calls, const fs::path &file, std::vector<char> bytes) {
    const std::vector<char> head(bytes.begin(), bytes.begin() + ELMOPP_STORE_HEAD);
    std::fill_n(bytes.begin() + mark_at, word_bytes, blank_byte);
    std::string trouble = write_all(calls, file.string(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, bytes);
    if (trouble.empty()) {
        trouble = write_all(calls, file.string(), O_WRONLY | O_CLOEXEC, head);
    }
    return trouble.empty() ? sync_folder(calls, file.parent_path().string()) : trouble;
}

/// Whoever waits for a disk must not keep the lamps waiting.
void give_up_urgency() {
    const sched_param plain{};
    (void)pthread_setschedparam(pthread_self(), SCHED_OTHER, &plain);
}

int open_file(const char *path, int flags, mode_t mode) {
    return ::open(path, flags, mode);
}

} // namespace

const FileCalls system_file_calls{open_file, ::write, ::fsync};

StoreFolder::StoreFolder(fs::path folder) : folder_(std::move(folder)) {
    const auto refuse = [this](const std::string &what) {
        throw BadRequest("--store " + folder_.string() + ": " + what +
                         "; right would be a folder of this controller's own that can be written to");
    };
    std::error_code error;
    if (!fs::is_directory(folder_, error)) {
        refuse("is no folder");
    }
    if (::access(folder_.c_str(), W_OK | X_OK) != 0) {
        refuse("cannot be written to");
    }
    descriptor_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        const bool taken = descriptor_ >= 0;
        if (taken) {
            (void)::close(descriptor_);
        }
        refuse(taken ? "is another controller's" : "cannot be read");
    }
}

StoreFolder::~StoreFolder() {
    (void)::close(descriptor_);
}

FileStore::FileStore(fs::path folder, std::string name, std::uint32_t image_bytes, const FileCalls &calls)
    : folder_(std::move(folder)), name_(std::move(name)), calls_(calls), slot_bytes_(ELMOPP_STORE_HEAD + image_bytes),
      sector_bytes_(slot_bytes_ + word_bytes), words_(sectors_of_files * sector_bytes_ / word_bytes, blank_word) {
    for (std::uint32_t sector = 0; sector < sectors_of_files; ++sector) {
        load(sector);
    }
}

fs::path FileStore::file_of(std::uint32_t sector) const {
    return folder_ / (name_ + "." + std::to_string(sector));
}

void FileStore::load(std::uint32_t sector) {
    const fs::path file = file_of(sector);
    std::error_code error;
    if (!fs::exists(file, error)) {
        return;
    }
    std::ifstream stream(file, std::ios::binary);
    if (!fs::is_regular_file(file, error) || !stream) {
        throw BadRequest("--store " + folder_.string() + ": " + file.filename().string() +
                         " cannot be read; right would be a file that this controller has written, or none");
    }
    std::vector<char> bytes(sector_bytes_ + 1U); // one more would be another file
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (stream.gcount() == static_cast<std::streamsize>(sector_bytes_)) {
        std::memcpy(&words_[sector * sector_bytes_ / word_bytes], bytes.data(), sector_bytes_);
    }
}

elmopp_store_medium_t FileStore::medium() const {
    elmopp_store_medium_t medium{};
    medium.bytes = reinterpret_cast<const std::uint8_t *>(words_.data());
    medium.sectors = sectors_of_files;
    medium.sector_bytes = sector_bytes_;
    medium.sector_slots = 1;
    medium.slot_bytes = slot_bytes_;
    medium.erases_any_time = true;
    return medium;
}

void FileStore::put(std::uint32_t at, std::uint32_t word) {
    words_.at(at / word_bytes) &= word;
}

/// The sector with its mark goes to the disk; when it is there the mark is set in memory, too.
elmopp_store_answer_t FileStore::seal(const elmopp_store_order_t &order) {
    const std::uint32_t sector = order.at / sector_bytes_;
    if (!writing_.valid()) {
        std::vector<std::uint32_t> words(words_);
        words.at(order.at / word_bytes) = order.word;
        const auto *const first = reinterpret_cast<const char *>(words.data()) + std::size_t{sector} * sector_bytes_;
        const std::vector<char> bytes(first, first + sector_bytes_);
        try {
            writing_ = std::async(std::launch::async, [calls = calls_, file = file_of(sector), bytes] {
                give_up_urgency();
                return write_file(calls, file, bytes);
            });
        } catch (const std::system_error &error) {
            trouble_ = error.what();
            return ELMOPP_STORE_FAILED;
        }
    }
    if (writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
        return ELMOPP_STORE_LATER;
    }
    trouble_ = writing_.get();
    if (!trouble_.empty()) {
        return ELMOPP_STORE_FAILED;
    }
    put(order.at, order.word);
    return ELMOPP_STORE_DONE;
}

elmopp_store_answer_t FileStore::carry_out(const elmopp_store_order_t &order) {
    if (order.action == ELMOPP_STORE_SEAL) {
        return seal(order);
    }
    if (order.action == ELMOPP_STORE_ERASE) {
        const auto first = words_.begin() + order.at / word_bytes;
        std::fill(first, first + sector_bytes_ / word_bytes, blank_word);
    } else {
        put(order.at, order.word);
    }
    return ELMOPP_STORE_DONE;
}

} // namespace elmopp

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Two functions of Python by which processes share work, as a member `exchange` of options.

#pragma once

#include <nanobind/nanobind.h>

#include <memory>
#include <string>

#include "base/work_exchange.h"

namespace eclat {

namespace nb = nanobind;

inline std::string string_of(const nb::handle& bytes) {
    const auto found = nb::cast<nb::bytes>(bytes);
    return {found.c_str(), found.size()};
}

inline nb::bytes bytes_of(const std::string& text) { return nb::bytes(text.data(), text.size()); }

inline std::shared_ptr<const WorkExchange> work_exchange(nb::object share, nb::object tell) {
    auto shared = [share](size_t count, uint64_t rays_of_item, const WorkRange& compute) {
        const nb::gil_scoped_acquire locked;
        const nb::object range = nb::cpp_function([&compute](size_t first, size_t end) {
            std::string found;
            {
                const nb::gil_scoped_release unlocked;
                found = compute(first, end);
            }
            return bytes_of(found);
        });
        const nb::object found = share(count, rays_of_item, range);
        WorkExchange::Answer answer;
        if (nb::isinstance<nb::bytes>(found))
            answer.digest = string_of(found);
        else
            for (const nb::handle bytes : found) answer.ranges.push_back(string_of(bytes));
        return answer;
    };
    auto told = [tell](const std::string& digest) {
        const nb::gil_scoped_acquire locked;
        tell(bytes_of(digest));
    };
    return std::make_shared<WorkExchange>(std::move(shared), std::move(told));
}

/// Defines the method by which options get the two functions.
template <class Options>
void def_share_work(nb::class_<Options>& type) {
    type.def(
        "share_work",
        [](Options& options, nb::object share, nb::object tell) { options.exchange = work_exchange(share, tell); },
        nb::arg("share"), nb::arg("tell"),
        "Lets functions share the work with other processes. `share` gets the number of items of a step, about how "
        "many rays "
        "each takes, and a function that computes a range of them as bytes. In the process that asks it returns the "
        "bytes of "
        "ranges that are all items, in order, and `tell` gets the digest of the step. In processes that follow `share` "
        "returns "
        "this digest.");
}

}  // namespace eclat

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Records as rows of floats.

#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "arrays.h"
#include "records/record.h"

namespace eclat {

static_assert(sizeof(IrradianceRecord) % sizeof(float) == 0);
inline constexpr size_t floats_per_record = sizeof(IrradianceRecord) / sizeof(float);

/// (records, floats): position, normal, E, excess, rotation gradient (RGB × xyz), translation gradient, R, radius and bounds.
inline auto to_array(const std::vector<IrradianceRecord>& records) {
    return float_array({records.size(), floats_per_record}, [&](float* data) {
        if (!records.empty()) std::memcpy(data, records.data(), records.size() * sizeof(IrradianceRecord));
    });
}

inline std::vector<IrradianceRecord> records_of(const Array<float, -1, -1>& values) {
    if (values.shape(1) != floats_per_record)
        throw std::invalid_argument("records: expected rows of " + std::to_string(floats_per_record) + " floats, got " +
                                    std::to_string(values.shape(1)));
    std::vector<IrradianceRecord> records(values.shape(0));
    if (!records.empty())
        std::memcpy(static_cast<void*>(records.data()), values.data(), records.size() * sizeof(IrradianceRecord));
    return records;
}

}  // namespace eclat

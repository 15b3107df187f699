// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The object that owns a scene for Python.

#pragma once

#include "transport/lit_scene.h"

namespace eclat {

using CoreScene = LitScene;

}  // namespace eclat

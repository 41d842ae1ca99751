// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// XDMF 2: the index by which ParaView finds frames in an HDF5 file. Of ParaView's readers of XDMF only "Xdmf Reader"
/// reads slabs of arrays (those of XDMF 3 skip them), and of its file name extensions only xdmf2 selects no other
/// reader.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace equidem {

/// The file whose frames are listed, as frames.hpp lays it out.
struct XdmfSource {
  std::string file;  ///< name, in the folder of the index
  std::uint64_t discs = 0;
  std::uint64_t room = 0;   ///< frames that it has room for
  bool travelling = false;  ///< points at `position`, which replaces displacement, as angle does rotation
  std::vector<std::string> of_discs = {};  ///< `discs/NAME`, beside the radius
};

/// One point in time: discs as points; radius, displacement, rotation, velocity, spin.
std::string xdmf_frame(const XdmfSource& source, std::uint64_t frame, double time);

/// The whole index.
/// \param frames xdmf_frame of all, one after another
std::string xdmf_text(const std::string& frames);

}  // namespace equidem

// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The damped oscillator g'' + 2 zeta g' + g = 0, g(0) = 0, g'(0) = 1, and its integrals, to round-off for every
/// damping and time.
///
/// A contact of linear spring and dashpot over one step, solved exactly, under an outside force that is linear in time.
///
/// u'' + 2 zeta w u' + w² u = h0 + h1 t while in contact, u'' = h0 + h1 t while apart; u the overlap, w = sqrt(k/m).
/// Contacts may begin and end any number of times in a step. The outside force stands for gravity and for all other
/// contacts of the two bodies: where it has their impulse and its first moment, the steps of all contacts together are
/// symplectic for zeta = 0, of fourth order on a straight chain, and exact for one contact.
///
/// Limit of the step. Contacts that move alike and interact, with the frequency of their common motion w sqrt(1 + rho)
/// (rho = 0: one contact alone; rho = 1: a straight chain whose discs move against their neighbours), are stable while
/// a step is shorter than half a period of it, w sqrt(1 + rho) dt < pi. The relative error of their frequency is -rho
/// (1 + rho) (w dt)⁴/1440.
#pragma once

#include "equidem/contact/restitution.hpp"

namespace equidem {

/// Values at one time x.
struct Response {
  double slope = 1;  ///< g'
  double g[5] = {};  ///< g[k]: the k-fold integral of g from 0
};

/// \param zeta >= 0; neither zeta = 1 nor its neighbourhood is special
/// \param x >= 0
Response response(double zeta, double x);

/// Integrals from 0 to x of g'², g², g[1]², 2 g' g, 2 g' g[1], 2 g g[1].
struct ResponseProducts {
  double of[6] = {};
};

ResponseProducts products_of_response(double zeta, double x);

/// Constants of a pair for all steps.
struct ExactPair {
  double reduced_mass = 0;  ///< kg
  double stiffness = 0;     ///< N/m
  double damping_ratio = 0;
  ContactEnd end = ContactEnd::at_zero_force;
  double step = 0;       ///< s
  double frequency = 0;  ///< w, 1/s
  /// Impulse and moment of a whole step in contact over the reduced mass, as factors of [overlap, closing, h0, h1].
  double impulse[4] = {}, moment[4] = {};
  /// Criterion, positive during contact: force over reduced mass, or overlap if the contact ends at zero overlap. At
  /// the start as factors of [overlap, closing], after the step of [overlap, closing, h0, h1].
  double hold[2] = {}, hold_after[4] = {};
  /// Loss over the reduced mass as a form of (v, b, h1), b = h0 - w² u: factors of v², b², h1², v b, v h1, b h1.
  double loss[6] = {};
};

/// \throws Error (bad_input) on numbers that are not positive (zeta: negative)
ExactPair exact_pair(double reduced_mass, double stiffness, double damping_ratio, ContactEnd end, double step);

/// Result of a contact in one step. With v' = v - impulse/m + h0 dt + h1 dt²/2 and u' = u + v dt - moment/m + h0 dt²/2
/// + h1 dt³/6 the energy m v²/2 (+ k u²/2 while touching) plus loss and release changes by the work of the outside
/// force, to round-off.
struct ExactStep {
  double impulse = 0;  ///< of the contact force over the step, >= 0 pushes, N s
  double moment = 0;   ///< integral of (dt - t) force dt, N s²: displaces each body by moment/mass
  double loss = 0;     ///< in the dashpot, J, >= 0
  /// Energy k u²/2 left in springs of contacts that ended at zero force, less that of contacts that resume before the
  /// bodies are apart, J. This energy is lost: the material relaxes without contact (Schwager & Poeschel 2007).
  double released = 0;
  bool touching_at_end = false;
  int beginnings = 0;  ///< contacts begun in the step
};

/// A step of more than 1000 beginnings and ends (which needs w dt > 1500) continues as a plastic impact and rest at
/// zero overlap.
/// \param overlap, closing at the start of the step, m and m/s (closing > 0 approaches); overlap < 0: apart
/// \param touching whether the contact continues from the previous step. A contact that ended at zero force while the
///        bodies overlap resumes when k u + c v is positive again: before they approach, without gain of energy
/// \param h0, h1 outside closing acceleration, m/s², and its rate, m/s³
ExactStep exact_step(const ExactPair& pair, double overlap, double closing, bool touching, double h0, double h1);

}  // namespace equidem

// SPDX-License-Identifier: GPL-3.0-or-later
const fills = ['#add4ed', '#f7d494', '#a8dec7', '#f0b899', '#e6c2d9', '#f7f0a6'];
const inks = ['#0073b3', '#bf8000', '#00805e', '#b34d00', '#a65985', '#8c8500'];
const player = document.currentScript.parentElement;
const [canvas, button, slider, clock] = ['canvas', 'button', 'input', 'span'].map(tag => player.querySelector(tag));
const draw = canvas.getContext('2d'), scale = canvas.width / data.size[0], frames = data.frames;
const shapes = data.bodies.map(body => {
  const shape = new Path2D();
  for (let p = 0; p < body.length; p += 4) {
    shape.moveTo(body[p] + body[p + 2], body[p + 1]);
    shape.ellipse(body[p], body[p + 1], body[p + 2], body[p + 3], 0, 0, 2 * Math.PI);
  }
  return shape;
});
const way = (bodies, g) =>
  Math.hypot(bodies[3 * g] - frames[0].bodies[3 * g], bodies[3 * g + 1] - frames[0].bodies[3 * g + 1]);
const farthest = frames.reduce(
  (far, frame) => data.bodies.reduce((most, _, g) => Math.max(most, way(frame.bodies, g)), far), 1);
const shade = (bodies, g) => {
  const part = way(bodies, g) / farthest;
  return `hsl(207, ${40 + 35 * part}%, ${94 - 66 * part}%)`;
};
const radii = data.bodies.map(body => new Path2D(`M${body[0]} ${body[1]}h${body[2]}`));  // show the rotation
function show(f) {
  const frame = frames[f], bodies = frame.bodies;
  draw.setTransform(1, 0, 0, 1, 0, 0);
  draw.clearRect(0, 0, canvas.width, canvas.height);
  draw.setTransform(scale, 0, 0, -scale, 0, canvas.height);
  shapes.forEach((shape, g) => {
    if (bodies[3 * g + 2] < 0) return;  // not there
    draw.save();
    draw.translate(bodies[3 * g] * data.unit, bodies[3 * g + 1] * data.unit);
    draw.rotate(bodies[3 * g + 2] * data.turn);
    draw.fillStyle = data.by_motion ? shade(bodies, g) : fills[data.groups[g] % 6];
    draw.strokeStyle = data.by_motion ? '#6f8496' : inks[data.groups[g] % 6];
    draw.lineWidth = 1.6 / scale;  // the fill covers its inner half and the edges between discs of one body
    draw.stroke(shape);
    draw.fill(shape);
    draw.lineWidth = 0.8 / scale;
    if (!data.by_motion) draw.stroke(radii[g]);
    draw.restore();
  });
  draw.lineWidth = 2 / scale;
  data.walls.forEach((points, w) => {
    if (frame.moves[2 * w] === null) return;  // not there
    draw.beginPath();
    for (let p = 0; p < points.length; p += 2)
      draw.lineTo(points[p] - data.low[0] + frame.moves[2 * w], points[p + 1] - data.low[1] + frame.moves[2 * w + 1]);
    draw.stroke();
  });
  slider.value = f;
  clock.textContent = 't = ' + frame.time.toPrecision(4) + ' s; the picture is ' + data.size[0].toPrecision(3) +
    ' m wide' + (data.speed == 1 ? '' : ', shown at ' + data.speed.toPrecision(2) + ' of its speed');
}
let playing, time = frames[0].time, last = performance.now(), f = 0;
function play(now) {
  if (playing) {
    time += (now - last) / 1000 * data.speed;
    if (time > frames[frames.length - 1].time + data.speed) time = frames[f = 0].time;
    while (f + 1 < frames.length && frames[f + 1].time <= time) ++f;
    show(f);
  }
  last = now;
  requestAnimationFrame(play);
}
function set_playing(on) {
  playing = on;
  button.textContent = on ? 'pause' : 'play';
}
slider.max = frames.length - 1;
button.onclick = () => set_playing(!playing);
slider.oninput = () => {
  set_playing(false);
  f = Number(slider.value);
  time = frames[f].time;
  show(f);
};
set_playing(!matchMedia('(prefers-reduced-motion: reduce)').matches);
show(0);
requestAnimationFrame(play);

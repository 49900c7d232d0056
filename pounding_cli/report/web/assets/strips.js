// The strips under the moving buildings: ground motion, roofs, link forces, with a cursor at the present.

const STRIP = 56;

/** What the strips show: name, unit, series with colour, factor into the unit. */
function stripsOf(scene, ink) {
  const roofs = scene.motions.map(({ floors }, number) => ({ series: floors.at(-1), color: ink.cases[number % 10], name: scene.buildings[number].name }));
  const strips = [
    { name: 'ground acceleration', ...scene.acceleration, lines: [{ series: scene.ground, color: ink.accent, name: '' }] },
    { name: 'roofs', unit: 'mm', factor: 1e3, lines: roofs },
  ];
  if (scene.forces.length) {
    strips.push({ name: 'link forces', unit: 'kN', factor: 1e-3, lines: scene.forces.map((series) => ({ series, color: ink.flash, name: '' })) });
  }
  for (const strip of strips) {
    const of = (sign) => Math.max(...strip.lines.map(({ series }) => series.reduce((most, value) => Math.max(most, sign * value || 0), 0)));
    strip.up = of(1);
    strip.down = of(-1);
    strip.most = Math.max(strip.up, strip.down);
  }
  return strips;
}

/** Draw the strips between two times; pixels with many samples show their extremes, so that no impact is lost. */
function drawStrips(canvas, scene, strips, from, to, time, width, ink) {
  const pen = sharp(canvas, width, STRIP * strips.length + 18);
  pen.clearRect(0, 0, width, STRIP * strips.length + 18);
  const x = (at) => ((at - from) / (to - from)) * width;
  strips.forEach((strip, number) => {
    const high = STRIP * number + 18, room = STRIP - 22, zoom = room / (strip.up + strip.down || 1);
    const middle = high + (strip.up + strip.down ? strip.up * zoom : room / 2);
    pen.strokeStyle = ink.line;
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(0, middle);
    pen.lineTo(width, middle);
    pen.stroke();
    for (const { series, color } of strip.lines) trace(pen, scene, series, from, to, width, (value) => middle - value * zoom, color);
    pen.fillStyle = ink.ink;
    pen.font = '12px system-ui, sans-serif';
    pen.textAlign = 'left';
    pen.fillText(`${strip.name}, up to ${asText(strip.most * strip.factor, 3)} ${strip.unit}`, 2, STRIP * number + 12);
    if (strip.lines.length > 1 && strip.lines[0].name && width > 520) names(pen, strip.lines, width, STRIP * number + 12);
  });
  pen.fillStyle = ink.soft;
  pen.font = '12px system-ui, sans-serif';
  for (const tick of ticksBetween(from, to, width / 90)) {
    if (tick < from) continue;
    pen.textAlign = tick === from ? 'left' : x(tick) > width - 24 ? 'right' : 'center';
    pen.fillText(`${Number(tick.toPrecision(6))} s`, x(tick), STRIP * strips.length + 15);
  }
  pen.strokeStyle = ink.ink;
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(x(time), 0);
  pen.lineTo(x(time), STRIP * strips.length);
  pen.stroke();
}

function names(pen, lines, width, y) {
  let right = width - 2;
  pen.textAlign = 'right';
  for (const { name, color } of [...lines].reverse()) {
    if (right < width * 0.45) return;
    pen.fillStyle = color;
    pen.fillText(name, right, y);
    right -= pen.measureText(name).width + 12;
  }
}

function trace(pen, scene, series, from, to, width, y, color) {
  const first = Math.max(0, Math.floor(from / scene.dt)), last = Math.min(scene.count - 1, Math.ceil(to / scene.dt));
  const perPixel = (last - first) / width;
  pen.strokeStyle = color;
  pen.lineWidth = 1.2;
  pen.beginPath();
  if (perPixel <= 1) {
    for (let place = first; place <= last; place++) pen.lineTo(((place * scene.dt - from) / (to - from)) * width, y(series[place]));
  } else {
    for (let pixel = 0; pixel < width; pixel++) {
      let low = Infinity, high = -Infinity;
      const end = Math.min(last, first + Math.ceil((pixel + 1) * perPixel));
      for (let place = first + Math.floor(pixel * perPixel); place <= end; place++) {
        low = Math.min(low, series[place]);
        high = Math.max(high, series[place]);
      }
      pen.lineTo(pixel, y(low));
      pen.lineTo(pixel, y(high));
    }
  }
  pen.stroke();
}

// One floor of every building from above at one instant: moved, turned, struck.

/** Where everything stands in a drawing from above of the given width: pixels a metre, places along the row [m]. */
function layoutAbove(scene, width, scale, gaps) {
  const plans = scene.buildings.map(({ plan }) => plan), depth = plans.reduce((sum, { depth: one }) => sum + one, 0), mean = depth / plans.length;
  const low = Math.min(...plans.map((plan) => plan.low)), high = Math.max(...plans.map((plan) => plan.high));
  const open = gaps.reduce((sum, gap) => sum + Math.max(gap, 0), 0), apart = gaps.filter((gap) => gap < 0).length * 0.4 * mean;
  const fits = (one) => scene.mostReached * one <= 0.22 * mean && scene.mostTurned * one <= 0.25 && open * one <= 0.3 * depth;
  const chosen = scale ?? SCALES.filter(fits).at(-1) ?? 1, between = gaps.map((gap) => (gap < 0 ? 0.4 * mean : gap * chosen));
  const aside = Math.min(scene.mostReached * chosen, 0.5 * mean), beyond = Math.min(scene.mostTurned * chosen, 0.3) * 0.5 * Math.max(...plans.map((plan) => plan.depth));
  const across = depth + open * chosen + apart + 2 * aside, along = high - low + 2 * beyond;
  const pixels = Math.min((width - 44) / across, Math.max(180, Math.min(360, innerHeight - 500)) / along), starts = [0];
  between.forEach((gap, number) => starts.push(starts.at(-1) + plans[number].depth + gap));
  const height = Math.round(along * pixels + 72), left = 30 + (width - 44 - (across - 2 * aside) * pixels) / 2;
  return { width, height, scale: chosen, pixels, middles: starts.map((start, number) => left + (start + plans[number].depth / 2) * pixels), base: height - 52 - beyond * pixels, low };
}

/** Draw a floor of every building at a time; `glow` as in `drawStage`. */
function drawAbove(canvas, scene, at, floor, time, glow, ink) {
  const pen = sharp(canvas, at.width, at.height), upward = (street) => at.base - (street - at.low) * at.pixels;
  pen.textEnds = {};
  const point = (building, level, along, street) => { // along the row from its centre, and the place along the street [m]
    const { centre } = scene.buildings[building].plan, turn = scene.turned(building, level, time);
    const moved = scene.moved(building, level, time) - (street - centre) * turn;
    return [at.middles[building] + (along + at.scale * moved) * at.pixels, upward(street + at.scale * along * turn)];
  };
  line(pen, ink.soft, 1.5, [[10, at.height - 22], [10, 16]]);
  area(pen, ink.soft, [[6, 18], [14, 18], [10, 8]]);
  pen.save();
  pen.translate(24, at.height - 30);
  pen.rotate(-Math.PI / 2);
  pen.font = '12px system-ui, sans-serif';
  write(pen, ink.soft, pen.measureText('along the street').width < at.height - 50 ? 'along the street' : 'street', 0, 0, 'left');
  pen.restore();
  write(pen, ink.soft, `floor ${floor} from above`, at.width - 2, 12, 'right');
  scene.buildings.forEach(({ heights, plan, name }, number) => {
    const level = Math.min(floor, heights.length), isHere = plan.wall || level === floor, half = plan.depth / 2, solid = plan.known ? [] : [6, 4];
    const corners = [[-half, plan.low], [half, plan.low], [half, plan.high], [-half, plan.high], [-half, plan.low]];
    pen.setLineDash([2, 4]);
    line(pen, ink.soft, 1, corners.map(([x, y]) => [at.middles[number] + x * at.pixels, upward(y)]));
    pen.setLineDash([]);
    pen.globalAlpha = isHere ? 0.16 : 0.05;
    area(pen, ink.slab, corners.map(([x, y]) => point(number, level, x, y)));
    pen.globalAlpha = isHere ? 1 : 0.35;
    for (const one of plan.across) drawLineAbove(pen, scene, number, level, one, time, [point(number, level, one.place, plan.low), point(number, level, one.place, plan.high)], ink, true);
    for (const one of plan.lines) drawLineAbove(pen, scene, number, level, one, time, [point(number, level, -half, one.place), point(number, level, half, one.place)], ink, false);
    pen.setLineDash(solid);
    line(pen, ink.slab, 2, corners.map(([x, y]) => point(number, level, x, y)));
    pen.setLineDash([]);
    if (plan.turns) {
      const [x, y] = point(number, level, 0, plan.centre);
      line(pen, ink.ink, 1.5, [[x - 5, y], [x + 5, y]]);
      line(pen, ink.ink, 1.5, [[x, y - 5], [x, y + 5]]);
    }
    pen.globalAlpha = 1;
    writeApart(pen, ink.ink, [name], at.middles[number], at.height - 22, Math.max(plan.depth * at.pixels * 1.2, SHORT_NAME), '600 12.5px');
    const turn = `${(1e3 * scene.turned(number, level, time)).toFixed(2).replace('-', '−')} mrad`;
    const texts = isHere ? [plan.turns ? turn : plan.wall ? 'wall' : 'does not twist'] : [`roof: floor ${level}`, `floor ${level}`];
    writeApart(pen, ink.soft, texts, at.middles[number], at.height - 6, plan.depth * at.pixels * 1.1);
  });
  scene.links.forEach((link, number) => {
    if (link.floor !== floor && link.right_floor !== floor) return;
    const face = (building, level, way, side) => point(building, level, (way * scene.buildings[building].plan.depth) / 2, link.places[side]);
    const ends = [face(link.left, link.floor, 1, 0), face(link.right, link.right_floor, -1, 1)], force = scene.between(scene.forces[number], time);
    const x = (ends[0][0] + ends[1][0]) / 2, y = (ends[0][1] + ends[1][1]) / 2;
    if (link.drawn === 'bar') {
      const color = force < 0 ? ink.pull : ink.flash, width = 2 + 4 * Math.abs(force / (scene.mostForce || 1));
      if (link.damper) drawDamper(pen, color, width, [ends[0][0] - 8, ends[0][1]], [ends[1][0] + 8, ends[1][1]]);
      else line(pen, color, width, [[ends[0][0] - 4, ends[0][1]], [ends[1][0] + 4, ends[1][1]]]);
      return;
    }
    if (link.drawn === 'filling') {
      pen.fillStyle = ink.infill;
      pen.fillRect(ends[0][0], y - 5, Math.max(Math.min(ends[1][0] - ends[0][0], link.gap * at.scale * at.pixels), 1), 10);
    }
    for (const [px, py] of ends) { // where they meet
      pen.fillStyle = ink.flash;
      pen.beginPath();
      pen.arc(px, py, 2.5, 0, 2 * Math.PI);
      pen.fill();
    }
    drawStar(pen, ink, x, y, glow[number]);
  });
}

function drawLineAbove(pen, scene, building, floor, one, time, ends, ink, isAcross) {
  const yielding = scene.yields && scene.turns[building] && scene.lineDemand(building, floor, one, time, isAcross) >= 1;
  line(pen, yielding ? ink.bad : isAcross ? ink.earth : ink.accent, 1.5 + 5 * one.share + (yielding ? 1 : 0), ends);
}

// Over the sweep: the largest mean ratio of a building against one swept key, a line a case.

function sweepView() {
  const controls = document.getElementById('sweep-controls');
  const box = document.getElementById('sweep-chart');
  const { axes, ratios, series } = data.sweep;
  const looks = caseLooks(data.cases);
  const unique = (key) => [...new Set(series.map((one) => one[key]))];
  const state = { ratio: unique('ratio')[0], building: data.building, analysis: unique('analysis')[0], axis: 0, at: axes.map(() => 0) };
  const set = (name) => (value) => {
    state[name] = name === 'axis' ? Number(value) : value;
    others();
    update();
  };
  controls.append(
    choice('Ratio', unique('ratio').map((key) => [key, ratios[key]]), state.ratio, set('ratio')).element,
    choice('Building', unique('building').map((name) => [name, name]), state.building, set('building')).element,
    choice('Analysis', unique('analysis').map((name) => [name, name]), state.analysis, set('analysis')).element,
  );
  if (axes.length > 1) controls.append(choice('Against', axes.map((one, number) => [String(number), one.label]), '0', set('axis')).element);
  const rest = h('span', { style: 'display:contents' });
  controls.append(rest);
  controls.addEventListener('submit', (event) => event.preventDefault());

  function others() {
    rest.replaceChildren(...axes.map((one, number) => (number === state.axis ? null
      : choice(one.label, one.values.map((value, place) => [String(place), String(value)]), String(state.at[number]), (value) => {
        state.at[number] = Number(value);
        update();
      }).element)).filter(Boolean));
  }

  /** Place of a point in the flat values: the last axis is the fastest. */
  const flat = (at) => at.reduce((sum, place, number) => sum * axes[number].values.length + place, 0);

  function update() {
    const chosen = axes[state.axis];
    const drawn = series.filter((one) => one.ratio === state.ratio && one.building === state.building && one.analysis === state.analysis);
    const lines = drawn.map((one) => ({
      name: one.case,
      look: looks.get(one.case),
      joined: chosen.numeric,
      points: chosen.values.map((value, place) => {
        const at = state.at.map((other, number) => (number === state.axis ? place : other));
        const y = one.values[flat(at)];
        return { x: chosen.numeric ? value : place + 1, y, low: null, high: null, said: [`${one.case}, ${chosen.label} = ${value}`, `largest ${ratios[state.ratio]} ${asText(y)}`] };
      }).filter((point) => point.y !== null).sort((a, b) => a.x - b.x),
    })).filter((one) => one.points.length);
    const count = chosen.values.length;
    const words = chosen.numeric ? {} : { ticks: chosen.values.map((_, place) => place + 1), names: chosen.values.map((value) => (count > 6 && String(value).length > 8 ? `${String(value).slice(0, 7)}…` : String(value))), low: 0.5, high: count + 0.5 };
    const positive = chosen.numeric && Math.min(...chosen.values) > 0;
    drawChart(box, {
      label: `Largest mean ${ratios[state.ratio]} of ${state.building}, ${state.analysis}, against ${chosen.label}`,
      height: 400,
      along: 'x',
      x: { label: chosen.label, log: chosen.numeric && positive && Math.max(...chosen.values) / Math.min(...chosen.values) > 20, ...words },
      y: { label: `largest mean ${ratios[state.ratio]}` },
      reference: 1,
      series: lines,
    });
  }
  others();
  const note = data.sweep.thinned > 1 ? h('p', { class: 'note' }, `Of the longest axes this page carries every ${data.sweep.thinned}th point at most.`) : null;
  const key = h('div', { class: 'legend', role: 'group', 'aria-label': 'Cases' }, ...[...looks].map(([name, look]) => h('label', {}, swatch(look), name)));
  box.before(key);
  if (note) box.after(note);
  drawnToWidth(box, update);
}

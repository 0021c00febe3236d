// Figures as people read them.
"use strict";

const Units = (() => {
  const grouped = new Intl.NumberFormat("en", { maximumFractionDigits: 0 });
  const known = (value) => value !== null && value !== undefined && Number.isFinite(value);

  // Three significant digits, no exponent; "–" for what was not measured.
  function figure(value) {
    if (!known(value)) return "–";
    const size = Math.abs(value);
    if (size >= 100 || value === 0) return grouped.format(value);
    return value.toFixed(size >= 10 ? 1 : 2);
  }

  function scaled(value, steps) {
    if (!known(value)) return "–";
    for (const [size, unit] of steps) if (Math.abs(value) >= size) return `${figure(value / size)} ${unit}`;
    return figure(value);
  }

  return {
    figure,
    known,
    ms: (value) => (known(value) ? `${figure(value)} ms` : "–"),
    bytes: (value) => (known(value) && Math.abs(value) < 1000 ? `${figure(value)} B`
      : scaled(value, [[1e9, "GB"], [1e6, "MB"], [1e3, "kB"]])),
    count: (value) => (known(value) && Math.abs(value) < 10000 ? grouped.format(value)
      : scaled(value, [[1e9, "G"], [1e6, "M"], [1e3, "k"]])),
    seconds: (value) => `${Math.floor(value / 60)}:${(value % 60).toFixed(1).padStart(4, "0")}`,
    words: (name) => name.replace(/_/g, " "),
  };
})();

export interface CanvasSize {
  readonly widthPx: number;
  readonly heightPx: number;
}

/** Chromium reports the box in CSS pixels under an emulated density (developer tools, tests). */
function isPlausible(boxPx: number, cssPx: number): boolean {
  return Math.abs(boxPx - cssPx * devicePixelRatio) <= 1;
}

/**
 * Reports the size of `element` in device pixels, now and whenever it changes: by layout, by zoom,
 * or by moving to a screen of another density. Returns a function that stops this.
 */
export function observeDevicePixelSize(element: Element, onSize: (size: CanvasSize) => void): () => void {
  let lastCss = { width: 0, height: 0 };
  const report = (width: number, height: number) =>
    onSize({ widthPx: Math.max(1, Math.round(width)), heightPx: Math.max(1, Math.round(height)) });
  const reportScaled = () => report(lastCss.width * devicePixelRatio, lastCss.height * devicePixelRatio);
  let hasDevicePixelBox = true;
  const observer = new ResizeObserver((entries) => {
    const entry = entries.at(-1);
    if (!entry) return;
    const box = entry.devicePixelContentBoxSize?.[0];
    hasDevicePixelBox = box !== undefined;
    lastCss = entry.contentRect;
    // Exact: at fractional scales, a rounded CSS size would make the browser resample the image.
    if (box && isPlausible(box.inlineSize, lastCss.width)) report(box.inlineSize, box.blockSize);
    else reportScaled();
  });
  try {
    observer.observe(element, { box: 'device-pixel-content-box' });
  } catch {
    // Safari does not know this box.
    hasDevicePixelBox = false;
    observer.observe(element);
  }

  // Without that box, only queries notice a change of density. Each query matches one density.
  const stop = new AbortController();
  const watchDensity = () => {
    matchMedia(`(resolution: ${devicePixelRatio}dppx)`).addEventListener(
      'change',
      () => {
        if (!hasDevicePixelBox) reportScaled();
        watchDensity();
      },
      { once: true, signal: stop.signal },
    );
  };
  watchDensity();
  return () => {
    observer.disconnect();
    stop.abort();
  };
}

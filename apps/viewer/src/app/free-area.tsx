import { useEffect, useRef } from 'react';
import { coveredBeside } from '../camera/covered.ts';
import type { Viewer } from '../engine/viewer.ts';

/** The part of the picture beside panels, as style sheets have it: the camera follows its size. */
export function FreeArea({ viewer }: { viewer: Viewer }) {
  const area = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const element = area.current;
    let size = { width: 0, height: 0 };
    const observer = new ResizeObserver(() => {
      if (!element) return;
      const { clientWidth: width, clientHeight: height } = document.documentElement;
      const isResized = width !== size.width || height !== size.height;
      size = { width, height };
      viewer.camera.setCovered(coveredBeside(element.getBoundingClientRect(), size), isResized);
    });
    if (element) observer.observe(element);
    return () => observer.disconnect();
  }, [viewer]);
  return <div ref={area} className="free-area" />;
}

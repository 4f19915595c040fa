// Hydrates the HTML that the test has rendered into the page.
import type { RootState } from '@react-three/fiber';
import { splatEngineOf } from '@websplatter/react';
import { hydrateRoot } from 'react-dom/client';
import { PosterPage } from './poster-page.tsx';

const served = {
  /** All Canvases so far, in order. */
  canvases: [] as RootState[],
  loseDevice: () => splatEngineOf(served.canvases.at(-1)!.gl).device.destroy(),
};

declare global {
  interface Window {
    served: typeof served;
  }
}

window.served = served;
hydrateRoot(
  document.getElementById('root')!,
  <PosterPage onCreated={(state) => void served.canvases.push(state)} />,
);

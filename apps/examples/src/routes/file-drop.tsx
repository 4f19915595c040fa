import { OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats, type SplatsProps } from '@websplatter/react';
import { SplatBounds } from '@websplatter/react/components';
import { Suspense, useEffect, useState } from 'react';

export default function FileDrop() {
  const [source, setSource] = useState<SplatsProps['src']>('ring.ply');
  const [message, setMessage] = useState('Drop a file of splats, or choose one.');
  const open = (file: File | undefined) => {
    if (!file) return;
    setMessage(`Reading ${file.name} …`);
    setSource(file);
  };
  useEffect(() => {
    const events = new AbortController();
    const { signal } = events;
    // Prevents the browser from opening the file instead of the page.
    addEventListener('dragover', (event) => event.preventDefault(), { signal });
    addEventListener(
      'drop',
      (event) => {
        event.preventDefault();
        open(event.dataTransfer?.files[0]);
      },
      { signal },
    );
    return () => events.abort();
  });
  return (
    <>
      <SplatCanvas flat camera={{ fov: 50, near: 0.05 }}>
        <Suspense>
          {/* A new source replaces the old splats once it has been read, and the camera frames it. */}
          <SplatBounds fit="each">
            <Splats
              src={source}
              onLoad={({ name, count }) => setMessage(`${name}: ${count.toLocaleString()} splats`)}
              onError={(error) => setMessage(String(error))}
            />
          </SplatBounds>
        </Suspense>
        <OrbitControls makeDefault />
      </SplatCanvas>
      <form className="panel">
        <output>{message}</output>
        <input
          type="file"
          aria-label="A file of splats"
          onChange={(event) => open(event.target.files?.[0])}
        />
      </form>
    </>
  );
}

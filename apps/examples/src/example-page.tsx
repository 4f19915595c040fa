import { SplatsFallback } from '@websplatter/react';
import { Suspense, use, useRef, useState } from 'react';
import type { Example } from './examples.ts';

/** An example on the whole page, below its title and a button that shows its source. */
export function ExamplePage({ example: { title, about, Component, loadSource } }: { example: Example }) {
  const dialog = useRef<HTMLDialogElement>(null);
  const [source, setSource] = useState<Promise<string>>();
  const showSource = () => {
    setSource((loading) => loading ?? loadSource());
    dialog.current?.showModal();
  };
  return (
    <div className="example">
      <header className="example-bar">
        <a href="./">Examples</a>
        <h1>{title}</h1>
        <button type="button" onClick={showSource}>
          Source
        </button>
      </header>
      <main className="stage">
        <SplatsFallback
          fallback={(error) => (
            <p className="unavailable" role="alert">
              {error.message}
            </p>
          )}
        >
          <Suspense>
            <Component />
          </Suspense>
        </SplatsFallback>
      </main>
      <dialog ref={dialog} className="source" aria-label={`Source of “${title}”`}>
        <form method="dialog">
          <p>{about}</p>
          <button type="submit">Close</button>
        </form>
        <Suspense>{source && <SourceText source={source} />}</Suspense>
      </dialog>
    </div>
  );
}

function SourceText({ source }: { source: Promise<string> }) {
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: the keyboard must reach text that scrolls.
    <pre tabIndex={0}>
      <code>{use(source)}</code>
    </pre>
  );
}

import './examples.css';
import { SplatsErrorBoundary } from '@websplatter/react';
import { StrictMode, Suspense, use, useRef, useState } from 'react';
import { createRoot } from 'react-dom/client';
import { EXAMPLES, type Example } from './examples.ts';

// As files: policies of pages may forbid images in the text of scripts.
const pictures = import.meta.glob<string>('../thumbnails/*.jpg', {
  query: '?no-inline',
  import: 'default',
  eager: true,
});

const name = new URLSearchParams(location.search).get('example');
const example = EXAMPLES.find((each) => each.name === name);
if (example) document.title = `${example.title} · WebSplatter examples`;

createRoot(document.getElementById('root')!).render(
  <StrictMode>{example ? <ExamplePage example={example} /> : <IndexPage missing={name} />}</StrictMode>,
);

/** `missing`: the example that the address names, if it does not exist. */
function IndexPage({ missing }: { missing: string | null }) {
  return (
    <main className="index">
      <header>
        <h1>WebSplatter in react-three-fiber</h1>
        <p>Small examples of one thing each. Every page shows its whole source.</p>
        {missing !== null && <p role="alert">There is no example “{missing}”. Choose one of these:</p>}
      </header>
      <ol>
        {EXAMPLES.map(({ name, title, about, alt }) => (
          <li key={name} className="index-entry">
            <a href={`?example=${name}`}>
              <img
                src={pictures[`../thumbnails/${name}.jpg`]}
                alt={alt}
                width={480}
                height={320}
                loading="lazy"
              />
              <h2>{title}</h2>
              <p>{about}</p>
            </a>
          </li>
        ))}
      </ol>
    </main>
  );
}

/** An example over the whole page, below its title and a button that shows its source. */
function ExamplePage({ example: { title, about, Component, loadSource } }: { example: Example }) {
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
        <SplatsErrorBoundary
          fallback={(error) => (
            <p className="unavailable" role="alert">
              {error.message}
            </p>
          )}
        >
          <Suspense>
            <Component />
          </Suspense>
        </SplatsErrorBoundary>
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

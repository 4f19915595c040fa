import { EXAMPLES } from './examples.ts';

// As files: a page's content security policy may forbid data URLs for images.
const pictures = import.meta.glob<string>('../thumbnails/*.jpg', {
  query: '?no-inline',
  import: 'default',
  eager: true,
});

/** `missing`: the unknown example that the URL names; null if there is none. */
export function IndexPage({ missing }: { missing: string | null }) {
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

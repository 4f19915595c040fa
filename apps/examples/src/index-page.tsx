import { EXAMPLES } from './examples.ts';

/** `missing`: what the address asked for, where there is no such example. */
export function IndexPage({ missing }: { missing: string | null }) {
  return (
    <main className="index">
      <header>
        <h1>WebSplatter in react-three-fiber</h1>
        <p>Small examples of one thing each. Every page shows its whole source.</p>
        {missing !== null && <p role="alert">There is no example “{missing}”. These there are:</p>}
      </header>
      <ol>
        {EXAMPLES.map(({ name, title, about }) => (
          <li key={name} className="index-entry">
            <a href={`?example=${name}`}>
              <h2>{title}</h2>
              <p>{about}</p>
            </a>
          </li>
        ))}
      </ol>
    </main>
  );
}

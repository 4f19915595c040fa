import { LICENSES_ADDRESS } from '../../viewer/src/state/licenses-address.ts';
import { LabPage, PAGES } from './page.tsx';

export default function OverviewPage() {
  return (
    <LabPage
      name={null}
      title="Test and measure this device"
      about="Measured here, in this browser; nothing leaves the page."
    >
      <ul className="overview">
        {PAGES.map(({ name, title, about }) => (
          <li key={name}>
            <h2>
              <a href={`?${name}`}>{title}</a>
            </h2>
            <p>{about}</p>
          </li>
        ))}
      </ul>
      {import.meta.env.PROD && (
        <p>
          <a href={LICENSES_ADDRESS}>Licences</a> of the npm packages in these pages.
        </p>
      )}
    </LabPage>
  );
}

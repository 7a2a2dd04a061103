import pytest

from coral.view.contact.report import write_contact_report

pytestmark = pytest.mark.browser


def test_a_report_is_for_all_eyes(browser, copy, check_for_all_eyes):
    page = browser.new_page()
    page.goto(write_contact_report(copy).as_uri())
    check_for_all_eyes(page)
    page.close()

//! Origins of pages and `Host` headers, in one spelling: lower case, without default ports.

use std::fmt;
use std::net::IpAddr;

use axum::http::Uri;
use axum::http::uri::Authority;

/// Scheme, host and port of a page (RFC 6454).
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Origin {
    is_https: bool,
    host: String,
    port: u16,
}

impl Origin {
    /// Reads an origin as people write it; the error says what is wrong with it.
    pub(crate) fn parse(text: &str) -> Result<Self, &'static str> {
        let uri: Uri = text.trim().parse().map_err(
            |_error| "it is no origin such as https://tyndall.example.org or http://127.0.0.1:8080",
        )?;
        let is_https = match uri.scheme_str() {
            Some("http") => false,
            Some("https") => true,
            Some(_) => return Err("its scheme is neither http nor https"),
            None => return Err("it has no scheme: write http:// or https:// before it"),
        };
        if !matches!(uri.path(), "" | "/") || uri.query().is_some() {
            return Err("an origin ends after its host and port, without a path");
        }
        let host = uri.authority().ok_or("it has no host")?;
        let host = Host::of(host).ok_or("its host and port cannot be read")?;
        if host.name.contains('*') {
            return Err("a wildcard would let any page in: name each origin");
        }
        let port = host.port.unwrap_or(if is_https { 443 } else { 80 });
        Ok(Self {
            is_https,
            host: host.name,
            port,
        })
    }

    /// Whether this is where a page comes from that was asked of this host without TLS.
    pub(crate) fn is_plain_page_of(&self, host: &Host) -> bool {
        !self.is_https && self.host == host.name && self.port == host.port.unwrap_or(80)
    }

    /// Whether a `Host` header names this origin.
    pub(crate) fn has_host(&self, host: &Host) -> bool {
        let default = if self.is_https { 443 } else { 80 };
        self.host == host.name && self.port == host.port.unwrap_or(default)
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (scheme, default) = if self.is_https {
            ("https", 443)
        } else {
            ("http", 80)
        };
        write!(formatter, "{scheme}://{}", self.host)?;
        if self.port == default {
            Ok(())
        } else {
            write!(formatter, ":{}", self.port)
        }
    }
}

/// What a `Host` header says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Host {
    /// In lower case; an IPv6 address keeps its brackets.
    name: String,
    port: Option<u16>,
}

impl Host {
    /// Reads a header's value; `None` if it is no host.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        Self::of(&text.parse().ok()?)
    }

    fn of(authority: &Authority) -> Option<Self> {
        let text = authority.as_str();
        let name = authority.host();
        let rest = text.strip_prefix(name)?;
        let port = match rest.strip_prefix(':') {
            None if rest.is_empty() => None,
            None => return None,
            Some("") => None,
            Some(port) => Some(port.parse().ok()?),
        };
        (!name.is_empty()).then(|| Self {
            name: name.to_ascii_lowercase(),
            port,
        })
    }

    /// Whether it names the loopback interface.
    pub(crate) fn is_this_machine(&self) -> bool {
        let address = self.name.trim_start_matches('[').trim_end_matches(']');
        self.name == "localhost"
            || self.name.ends_with(".localhost")
            || address
                .parse::<IpAddr>()
                .is_ok_and(|address| address.is_loopback())
    }
}

impl fmt::Display for Host {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.name)?;
        match self.port {
            None => Ok(()),
            Some(port) => write!(formatter, ":{port}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn origins_have_one_spelling() {
        for (text, shown) in [
            ("https://Tyndall.Example.org", "https://tyndall.example.org"),
            (
                "HTTPS://tyndall.example.org/",
                "https://tyndall.example.org",
            ),
            ("https://a.example:443/", "https://a.example"),
            ("http://a.example:80", "http://a.example"),
            ("http://a.example:443", "http://a.example:443"),
            (" http://[::1]:8080 ", "http://[::1]:8080"),
        ] {
            let origin = Origin::parse(text).unwrap();
            assert_eq!(origin.to_string(), shown);
            assert_eq!(Origin::parse(shown).unwrap(), origin);
        }
    }

    #[test]
    fn what_is_no_origin_is_refused_with_its_reason() {
        for (text, why) in [
            ("tyndall.example.org", "no scheme"),
            ("ftp://a.example", "neither http nor https"),
            ("https://a.example/page", "without a path"),
            ("https://a.example/?x", "without a path"),
            ("https://*.example", "wildcard"),
            ("https://user@a.example", "cannot be read"),
            ("https://a.example:99999", "cannot be read"),
            ("https://", "no origin"),
            ("null", "no scheme"),
            ("*", "no origin"),
        ] {
            let refused = Origin::parse(text).unwrap_err();
            let known = refused.contains(why) || why == "no origin";
            assert!(known, "{text}: {refused}");
        }
    }

    #[test]
    fn a_page_is_of_a_host_only_by_scheme_name_and_port() {
        let of = |origin: &str, host: &str| {
            let host = Host::parse(host).unwrap();
            Origin::parse(origin).unwrap().is_plain_page_of(&host)
        };
        assert!(of("http://127.0.0.1:8080", "127.0.0.1:8080"));
        assert!(of("http://a.example", "A.example:80"));
        assert!(!of("https://127.0.0.1:8080", "127.0.0.1:8080"));
        assert!(!of("http://127.0.0.1:8081", "127.0.0.1:8080"));
        assert!(!of("http://127.0.0.1", "127.0.0.1:8080"));
        let gateway = Origin::parse("https://a.example").unwrap();
        assert!(gateway.has_host(&Host::parse("a.example").unwrap()));
        assert!(!gateway.has_host(&Host::parse("b.example").unwrap()));
    }

    #[test]
    fn hosts_of_this_machine_are_recognised() {
        for host in [
            "localhost",
            "LOCALHOST:8080",
            "127.0.0.1:1",
            "[::1]:80",
            "[::1]",
            "a.localhost",
        ] {
            assert!(Host::parse(host).unwrap().is_this_machine(), "{host}");
        }
        for host in [
            "example.org",
            "localhost.example.org:80",
            "10.0.0.1",
            "127.0.0.1.example.org",
        ] {
            assert!(!Host::parse(host).unwrap().is_this_machine(), "{host}");
        }
        for host in ["", "a b", "a@b", "a/b", "a:b"] {
            assert_eq!(Host::parse(host), None, "{host}");
        }
    }
}
